"""Resolve the name plate of a device, its axes and its errata."""

from __future__ import annotations

from collections.abc import Iterable

from odsmith.model import AxisArea, EdsInfo, Erratum, Identity, Revision
from odsmith.resolve.problems import Node, section, sources


def resolve_identity(node: Node) -> Identity:
    """The `device` section."""
    eds = node["eds"]
    return Identity(
        identifier=node["identifier"],
        name=node["name"],
        title=node["title"],
        text=node["text"],
        version=str(node["version"]),
        vendor=node["vendor"],
        vendor_id=node["vendor_id"],
        product_code=node["product_code"],
        revision_number=node["revision_number"],
        order_code=node.get("order_code", node["name"]),
        profile=node["profile"],
        manual=node.get("manual", ""),
        bit_rates=tuple(sorted(node["bit_rates"])),
        digital_inputs=section(node, "inputs").get("digital", 0),
        digital_outputs=section(node, "outputs").get("digital", 0),
        analog_inputs=section(node, "inputs").get("analog", 0),
        analog_outputs=section(node, "outputs").get("analog", 0),
        eds=EdsInfo(
            file=eds["file"],
            version=eds["version"],
            revision=eds["revision"],
            description=eds["description"],
            created_by=eds["created_by"],
            creation_date=eds["creation_date"],
            creation_time=eds["creation_time"],
            modified_by=eds.get("modified_by", eds["created_by"]),
            modification_date=eds.get("modification_date", eds["creation_date"]),
            modification_time=eds.get("modification_time", eds["creation_time"]),
            comments=tuple(eds.get("comments", ())),
        ),
        own_manual=node.get("own_manual", ""),
        vendor_eds=node.get("vendor_eds", ""),
        firmware=_revisions(node.get("firmware", ())),
        changes=_revisions(node.get("changes", ())),
        place=node.where,
    )


def _revisions(nodes: Iterable[Node]) -> tuple[Revision, ...]:
    return tuple(Revision(str(node["version"]), str(node["date"]), node["text"]) for node in nodes)


def resolve_areas(spec: Node) -> tuple[AxisArea, ...]:
    """The index ranges that repeat per axis, then those that the device has once."""
    axes = section(spec, "axes")
    per_axis = (
        AxisArea(name, node["first"], node["last"], node["stride"], node.where)
        for name, node in section(axes, "areas").items()
    )
    once = (AxisArea("device_wide", node["first"], node["last"], 0, node.where) for node in axes.get("device_wide", ()))
    return (*per_axis, *once)


def resolve_errata(spec: Node) -> tuple[Erratum, ...]:
    """The errata, in the order of their ids."""
    errata = (
        Erratum(
            id=node["id"],
            severity=node["severity"],
            title=node["title"],
            printed=node["printed"],
            modelled=node["modelled"],
            why=node["why"],
            evidence=node["evidence"],
            paths=tuple(node["paths"]),
            source=sources(node),
            vendor=tuple(section(node, "vendor").items()),
            place=node.where,
        )
        for node in spec.get("errata") or ()
    )
    return tuple(sorted(errata, key=lambda erratum: (len(erratum.id), erratum.id)))
