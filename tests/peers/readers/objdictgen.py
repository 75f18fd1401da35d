"""objdictgen: the node that its editor and its C generator work on."""

from __future__ import annotations

from objdictgen.eds_utils import generate_node
from objdictgen.node import Node

from .program import Rows, Tables, main


def read(path: str, node_id: int) -> tuple[Tables, list[str]]:
    node = generate_node(path, node_id)
    return {
        "device": {
            "": {
                "product_name": node.Name,
                "description": node.Description,
                "boot_up_slave": node.Type == "slave",
            }
        },
        "objects": {f"{index:04X}": {"name": node.GetEntryName(index)} for index in node},
        "entries": entries(node),
    }, []


def entries(node: Node) -> Rows:
    found: Rows = {}
    for index in node:
        values, texts = node.GetEntry(index), node.GetEntry(index, compute=False)
        for sub, value in enumerate(values if isinstance(values, list) else [values]):
            text = texts[sub] if isinstance(texts, list) else texts
            infos = node.GetSubentryInfos(index, sub)
            found[f"{index:04X}:{sub:X}"] = {
                "name": infos["name"],
                "type": infos["type"],
                "sdo_access": infos["access"],
                "value": value,
                "relative": "$NODEID" in str(text),
                "mappable": infos["pdo"],
            }
    return found


if __name__ == "__main__":
    main("objdictgen", read)
