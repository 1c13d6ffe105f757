"""Meshes as they are sent: matt, and seen from both sides."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, cast

if TYPE_CHECKING:
    import trimesh


def as_matt_glb(mesh: trimesh.Trimesh) -> bytes:
    """A mesh as binary glTF, in the colours of its points or of its texture.

    What trimesh writes of itself is metal to a viewer, as that is the format's default, and metal without
    surroundings to mirror is nearly black.
    """
    return cast("bytes", mesh.export(file_type="glb", tree_postprocessor=_matt))


def _matt(tree: dict[str, Any]) -> None:
    materials = tree.get("materials") or [{}]
    for material in materials:
        texture = material.get("pbrMetallicRoughness", {}).get("baseColorTexture")
        plain = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
        material["pbrMetallicRoughness"] = plain if texture is None else {**plain, "baseColorTexture": texture}
        material["doubleSided"] = True
    tree["materials"] = materials
    for mesh in tree["meshes"]:
        for part in mesh["primitives"]:
            part.setdefault("material", 0)
