"""canmatrix: frames and signals. Every number of the dictionary is a signal of the SDO frames, every PDO a frame."""

from __future__ import annotations

from typing import Any

import canmatrix.formats

from .program import Rows, Tables, main


def read(path: str, node_id: int) -> tuple[Tables, list[str]]:
    load: Any = canmatrix.formats.loadp  # its options are said to be text, this one is a number
    (matrix,) = load(path, eds_node_id=node_id).values()
    frames = [frame for frame in matrix.frames if not frame.name.startswith("SDO_")]
    return {
        "device": {"": {"symbol": next(ecu.name for ecu in matrix.ecus if ecu.name != "PLC")}},
        "numbers": numbers(matrix.frame_by_name("SDO_receive")),
        "frames": {frame.name: pdo(frame) for frame in frames},
        "signals": {
            f"{frame.name}/{place}": signal(item) for frame in frames for place, item in enumerate(frame.signals)
        },
    }, []


def numbers(frame: Any) -> Rows:
    """Signals whose multiplexer is index and sub-index, in the order of the bytes on the bus."""
    return {
        f"{item.mux_val & 0xFFFF:04X}:{item.mux_val >> 16:X}": {
            "symbol": item.name,
            "bits": item.size,
            "signed": item.is_signed,
        }
        for item in frame.signals
        if item.muxer_for_signal == "IDX"
    }


def pdo(frame: Any) -> dict[str, object]:
    return {
        "can_id": frame.arbitration_id.id,
        "sent": bool(frame.transmitters),
        "bytes": frame.size,
    }


def signal(item: Any) -> dict[str, object]:
    return {
        "symbol": item.name,
        "start": item.start_bit,
        "bits": item.size,
        "signed": item.is_signed,
        "least": int(item.min),
        "most": int(item.max),
        "factor": int(item.factor),
        "offset": int(item.offset),
    }


if __name__ == "__main__":
    main("canmatrix", read)
