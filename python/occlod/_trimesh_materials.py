"""Materials of trimesh, with their images."""

from __future__ import annotations

import io
from typing import Any

import numpy

from ._occlod import AlphaMode, Material, Mesh, Surface, Texture, TextureMap, TextureWrap

_FROM_MODE = {"MASK": AlphaMode.mask, "BLEND": AlphaMode.blend}
_TO_MODE = {AlphaMode.mask: "MASK", AlphaMode.blend: "BLEND"}
_MAPS = {
    "metallicRoughnessTexture": "metallic_map",
    "normalTexture": "normal_map",
    "occlusionTexture": "occlusion_map",
    "emissiveTexture": "emissive_map",
}


def _linear(srgb: Any) -> list[float]:
    """Light of the three channels of sRGB, 0 to 1."""
    return [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in srgb]


def _given(image: Any) -> Any:
    """The image; None where there is none, or no Pillow to hold it."""
    try:
        return image if callable(image.save) else None
    except (AttributeError, ImportError):
        return None


def _is_empty(material: Any) -> bool:
    """Whether it is what trimesh gives to meshes without one."""
    import trimesh

    empty = trimesh.visual.material.empty_material()
    if type(material) is not type(empty) or not numpy.array_equal(material.diffuse, empty.diffuse):
        return False
    image, usual = _given(material.image), _given(empty.image)
    return image is None or (usual is not None and image.size == usual.size and image.tobytes() == usual.tobytes())


class MaterialsFrom:
    """Materials and textures of a mesh, from those of trimesh. An image that several use is there once."""

    def __init__(self) -> None:
        self.materials: list[Material] = []
        self.textures: list[Texture] = []
        self.lost: list[str] = []
        self._numbers: dict[int, int] = {}
        self._images: list[Any] = []  # kept, so that their addresses stay theirs

    def add(self, material: Any) -> None:
        """Of several materials each; of None a plain one."""
        for one in getattr(material, "materials", [material]):
            if one is None or _is_empty(one):
                self.materials.append(Material())
            else:
                self.materials.append(self._pbr(one) if hasattr(one, "baseColorFactor") else self._simple(one))

    def has_any(self) -> bool:
        """Whether one is more than plain."""
        return any(material != Material() for material in self.materials)

    def _texture(self, image: Any) -> int | None:
        image = _given(image)
        if image is None:
            return None
        if id(image) not in self._numbers:
            png = io.BytesIO()
            image.save(png, "PNG")
            self._numbers[id(image)] = len(self.textures)
            self._images.append(image)
            self.textures.append(Texture(mime_type="image/png", bytes=png.getvalue()))
        return self._numbers[id(image)]

    def _pbr(self, m: Any) -> Material:
        color = (255, 255, 255, 255) if m.baseColorFactor is None else m.baseColorFactor
        texture = self._texture(m.baseColorTexture)
        surface = Surface(
            alpha_mode=_FROM_MODE.get(m.alphaMode, AlphaMode.by_color),
            alpha_cutoff=0.5 if m.alphaCutoff is None else m.alphaCutoff,
            double_sided=bool(m.doubleSided),
            metallic=1.0 if m.metallicFactor is None else m.metallicFactor,
            roughness=1.0 if m.roughnessFactor is None else m.roughnessFactor,
            emissive=(0.0, 0.0, 0.0) if m.emissiveFactor is None else tuple(float(c) for c in m.emissiveFactor),
            **{ours: TextureMap(self._texture(getattr(m, theirs))) for theirs, ours in _MAPS.items()},
        )
        r, g, b, a = (float(c) / 255 for c in color)
        return Material(m.name or "", base_color=(r, g, b, a), texture=texture, surface=surface)

    def _simple(self, m: Any) -> Material:
        usual = type(m)()
        for name in ("ambient", "specular", "glossiness"):
            if not numpy.array_equal(getattr(m, name, None), getattr(usual, name, None)):
                self.lost.append(f'{name} of material "{m.name or ""}"')
        given = not numpy.array_equal(m.diffuse, usual.diffuse)  # else trimesh has grey, which no file says
        r, g, b, a = (float(c) / 255 for c in m.diffuse) if given else (1.0, 1.0, 1.0, 1.0)
        r, g, b = _linear((r, g, b))
        return Material(m.name or "", base_color=(r, g, b, a), texture=self._texture(m.image))


def _image(texture: Texture) -> Any:
    """None where the mesh has only the name of its file."""
    if not texture.bytes:
        return None
    try:
        import PIL.Image

        return PIL.Image.open(io.BytesIO(texture.bytes))
    except (ImportError, OSError):
        return None


def material_to(mesh: Mesh, lost: list[str]) -> Any:
    """The material of trimesh for all of the mesh: of several, one that holds them."""
    import trimesh

    images = [_image(texture) for texture in mesh.textures]
    for number, (texture, image) in enumerate(zip(mesh.textures, images)):
        if image is None:
            lost.append(f'image "{texture.file}"' if texture.file else f"image of type {texture.mime_type}")
        elif (texture.wrap_s, texture.wrap_t) != (TextureWrap.repeat, TextureWrap.repeat):
            lost.append(f"wrapping of image {number}")
    for material in mesh.materials:
        maps = [getattr(material.surface, ours) for ours in _MAPS.values()]
        if material.surface.unlit:
            lost.append(f'unlit of material "{material.name}"')
        if any(m != TextureMap(m.texture) for m in maps):
            lost.append(f'places and strengths of maps of material "{material.name}"')

    def image_of(number: int | None) -> Any:
        return None if number is None else images[number]

    def pbr(m: Material) -> Any:
        s = m.surface
        return trimesh.visual.material.PBRMaterial(
            name=m.name,
            baseColorFactor=numpy.rint(numpy.array(m.base_color) * 255).astype(numpy.uint8),
            baseColorTexture=image_of(m.texture),
            metallicFactor=s.metallic,
            roughnessFactor=s.roughness,
            emissiveFactor=s.emissive,
            alphaMode=_TO_MODE.get(s.alpha_mode),
            alphaCutoff=s.alpha_cutoff if s.alpha_mode == AlphaMode.mask else None,
            doubleSided=s.double_sided,
            **{theirs: image_of(getattr(s, ours).texture) for theirs, ours in _MAPS.items()},
        )

    made = [pbr(material) for material in mesh.materials]
    return made[0] if len(made) == 1 else trimesh.visual.material.MultiMaterial(made)
