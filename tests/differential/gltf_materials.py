"""Materials of glTF: factors, textures, vertex colours and the extensions that describe colours."""
import numpy

from figures import voxels_of
from frames import linear
from images import Image

OTHER_TEXTURES = "textures other than base colours and normal maps, not used"
NO_UV = "primitives without the texture coordinates of their texture"
REPEAT, MIRROR, CLAMP = 10497, 33648, 33071


def srgb(value):
    """Returns the sRGB code of a linear value."""
    v = min(max(value, 0), 1)
    return round(255 * (12.92 * v if v <= 0.0031308 else 1.055 * v ** (1 / 2.4) - 0.055))


class Materials:
    def __init__(self, odd, writer):
        self.odd, self.writer = odd, writer
        self.materials, self.textures, self.images, self.samplers = [], [], [], []
        self.choice, self.can_be_missing, self.is_missing = None, False, False

    def lists(self):
        named = {"materials": self.materials, "textures": self.textures, "images": self.images,
                 "samplers": self.samplers}
        return {name: entries for name, entries in named.items() if entries}

    def save(self, part):
        """Makes a choice for all primitives of a part."""
        self.choice = None
        return self.odd.choice(["none", "factor", "unlit"]) if part.place is None else None

    def restore(self, state):
        self.choice = state

    def add(self, entry):
        if self.odd.maybe(0.3):
            entry["name"] = self.odd.choice(["", "a", "名", "x" * 200])
        if self.odd.maybe(0.3):
            entry["doubleSided"] = self.odd.maybe()
        self.materials.append(entry)
        return len(self.materials) - 1

    def material(self, part, attributes):
        """Returns the index of a material, or None, and the voxels of the part."""
        odd = self.odd
        if part.place is not None:
            return self.textured(part, attributes)
        kind = self.choice or odd.choice(["none", "factor", "factor", "vertex", "vertex", "both", "unlit", "gloss",
                                          "emissive", "technique", "no uv"])
        values = [linear(c) for c in part.colour]
        if kind == "none":
            return None, voxels_of([part], (255, 255, 255))
        if kind in ("vertex", "both"):
            return self.coloured(part, attributes, kind)
        if kind == "gloss":
            self.writer.use("KHR_materials_pbrSpecularGlossiness", odd.maybe(0.3))
            gloss = {"diffuseFactor": [*values, 1], "specularFactor": [1, 1, 1]}
            entry = {"extensions": {"KHR_materials_pbrSpecularGlossiness": gloss}}
            if odd.maybe():
                entry["pbrMetallicRoughness"] = {"baseColorFactor": [0.3, 0.3, 0.3, 1]}
            return self.add(entry), voxels_of([part])
        if kind == "technique":
            self.writer.use("KHR_techniques_webgl")
            name = odd.choice(["u_diffuse", "diffuse", "u_diffuseColor"])
            technique = {"technique": 0, "values": {name: [c / 255 for c in part.colour] + [1]}}
            return self.add({"extensions": {"KHR_techniques_webgl": technique}}), voxels_of([part])
        if kind == "no uv":
            self.writer.warn(NO_UV)
            image = Image(odd, ("png",))
            self.can_be_missing = False
            texture = {"index": self.add_texture(image, None)}
            entry = {"pbrMetallicRoughness": {"baseColorTexture": texture, "baseColorFactor": [*values, 1]}}
            return self.add(entry), voxels_of([part])
        if kind == "emissive":
            entry = {"pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "emissiveFactor": values}
            return self.add(entry), voxels_of([part])
        entry = {"pbrMetallicRoughness": {"baseColorFactor": [*values, 1], "metallicFactor": odd.choice([0, 1])}}
        alpha = self.add_alpha(entry, entry["pbrMetallicRoughness"]["baseColorFactor"])
        if kind == "unlit":
            self.writer.use("KHR_materials_unlit")
            entry["extensions"] = {"KHR_materials_unlit": {}}
        if max(part.colour) > 0 and odd.maybe(0.1):
            entry["emissiveFactor"] = [0.1, 0.2, 0.3]  # a bake ignores light that is added to a colour
        return self.add(entry), voxels_of([part], None, alpha)

    def add_alpha(self, entry, factor):
        """Adds an alpha mode. Returns the alpha of the voxels."""
        kind = self.odd.choice(["none"] * 5 + ["OPAQUE", "BLEND", "MASK", "whole BLEND"])
        if kind == "none" or self.choice:  # all primitives of a part have the same alpha
            return 255
        entry["alphaMode"] = kind.split()[-1]
        if kind == "whole BLEND":
            return 255
        factor[3] = self.odd.choice([0.25, 0.75])
        if kind == "MASK":
            entry["alphaCutoff"] = 0.1
        return round(255 * factor[3]) if kind == "BLEND" else 255

    def coloured(self, part, attributes, kind):
        """Adds colours to vertices, in some files with a factor."""
        odd = self.odd
        values = numpy.array([linear(c) for c in part.colour])
        width = odd.choice([3, 4])
        number = odd.choice(["f4", "u1", "u2"])
        maximum = {"f4": 1, "u1": 255, "u2": 65535}[number]
        stored = values if number == "f4" else numpy.round(values * maximum)
        rows = numpy.tile([*stored, maximum][:width], (len(part.points), 1))
        keys = {} if number == "f4" else {"normalized": True}
        attributes["COLOR_0"] = self.writer.buffers.accessor(rows, number, f"VEC{width}", **keys)
        seen, material = stored / maximum, None
        if kind == "both":
            factor = [odd.choice([0.5, 1, 0.25]) for _ in range(3)]
            seen = seen * factor
            material = self.add({"pbrMetallicRoughness": {"baseColorFactor": [*factor, 1]}})
        return material, voxels_of([part], tuple(srgb(v) for v in seen))

    def sampler(self):
        """Returns the wrap modes along both axes, and the index of a sampler with them. None means repeat."""
        odd = self.odd
        if odd.maybe(0.3):
            return (REPEAT, REPEAT), None
        modes = odd.choice([REPEAT, REPEAT, MIRROR, CLAMP]), odd.choice([REPEAT, REPEAT, MIRROR, CLAMP])
        entry = {name: mode for name, mode in zip(("wrapS", "wrapT"), modes) if mode != REPEAT or odd.maybe()}
        if odd.maybe(0.3):
            entry["magFilter"] = odd.choice([9728, 9729])
            entry["minFilter"] = odd.choice([9728, 9729, 9984, 9987])
        self.samplers.append(entry)
        return modes, len(self.samplers) - 1

    @staticmethod
    def wrapped(mode, block, blocks):
        """Returns the visible block of an image. Rows count from below, so a mirrored row has the parity of 1 - v."""
        if mode == CLAMP:
            return min(max(block, 0), blocks - 1)
        if mode == MIRROR and (block // blocks) % 2:
            return blocks - 1 - block % blocks
        return block % blocks

    def transformed(self, uv, info):
        """Returns coordinates that KHR_texture_transform maps to uv."""
        odd = self.odd
        offset = numpy.array([odd.choice([0, 0.5, -2]), odd.choice([0, 0.25, 1])])
        scale = numpy.array([odd.choice([1, 2, 0.5, -1]), odd.choice([1, 3, 0.5])])
        quarter = odd.choice([0, 0, 1, 2, 3])
        angle = quarter * numpy.pi / 2
        cos, sin = numpy.cos(angle), numpy.sin(angle)
        # The extension: uv' = T R S uv, with R = [cos, sin; -sin, cos].
        turn = numpy.array([[cos, sin], [-sin, cos]])
        transform = {"offset": offset.tolist(), "scale": scale.tolist(), "rotation": angle}
        if odd.maybe(0.2):
            transform["texCoord"] = info.get("texCoord", 0)
            info["texCoord"] = 0
        info["extensions"] = {"KHR_texture_transform": transform}
        self.writer.use("KHR_texture_transform", odd.maybe(0.3))
        return (uv - offset) @ numpy.linalg.inv(turn).T / scale

    def alpha_mode(self, alpha):
        """Returns the keys of a material whose image has this alpha, and the alpha of voxels."""
        kind = self.odd.choice(["none", "OPAQUE", "BLEND", "MASK"])
        if alpha is None or kind in ("none", "OPAQUE"):
            return {} if kind == "none" else {"alphaMode": "OPAQUE"}, 255
        if kind == "BLEND":
            return {"alphaMode": "BLEND"}, alpha
        return {"alphaMode": "MASK", **({"alphaCutoff": 0.2} if alpha < 128 else {})}, 255

    def add_texture(self, image, sampler):
        odd, writer = self.odd, self.writer
        if writer.is_closed or odd.maybe(0.4):
            entry = {"bufferView": writer.buffers.view(image.data), "mimeType": image.media_type}
        else:
            entry = {"uri": writer.store(image.media_type, image.data, "." + image.suffix)}
            if self.can_be_missing and odd.beyond(0.15):
                entry["uri"] = odd.choice(["gone.png", "no folder/gone.jpg", "../above.png", "http://localhost/a.png"])
                self.is_missing = True
        self.images.append(entry)
        texture = {"source": len(self.images) - 1}
        if image.suffix == "webp":
            texture = {"extensions": {"EXT_texture_webp": {"source": len(self.images) - 1}}}
            writer.use("EXT_texture_webp", True)
            writer.case.outside["unsupported"] = "WebP"
        if sampler is not None:
            texture["sampler"] = sampler
        self.textures.append(texture)
        return len(self.textures) - 1

    def textured(self, part, attributes):
        odd, writer = self.odd, self.writer
        alpha = odd.choice([None, None, None, None, 0x40, 0xc0])
        image = Image(odd, alpha=alpha)
        modes, sampler = self.sampler()
        self.can_be_missing, self.is_missing = image.suffix != "webp", False
        info = {"index": self.add_texture(image, sampler)}
        uv = part.place / image.blocks
        uv[:, 1] = 1 - uv[:, 1]
        unused = odd.beyond(0.2)
        if unused:
            info["texCoord"] = 1
        if odd.maybe(0.3):
            uv = self.transformed(uv, info)
        name = "TEXCOORD_1" if unused else "TEXCOORD_0"
        attributes[name] = writer.buffers.plain(uv, "VEC2")
        if unused:
            attributes["TEXCOORD_0"] = writer.buffers.plain(numpy.zeros((len(uv), 2)), "VEC2")
        entry = {"pbrMetallicRoughness": {"baseColorTexture": info}}
        if odd.maybe(0.1):
            entry = {"extensions": {"KHR_materials_pbrSpecularGlossiness": {"diffuseTexture": info}}}
            writer.use("KHR_materials_pbrSpecularGlossiness")
        elif odd.maybe(0.1):
            entry = {"emissiveTexture": info, "emissiveFactor": [1, 1, 1],
                     "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}}
        elif odd.maybe(0.1) and not self.is_missing:
            unread = odd.maybe()
            entry["occlusionTexture" if unread else "normalTexture"] = {"index": info["index"]}
            if unread:
                writer.warn(OTHER_TEXTURES)
        writer.case.colour_tolerance = max(writer.case.colour_tolerance, image.tolerance)
        mode, visible = self.alpha_mode(alpha)
        if "emissiveTexture" not in entry:
            entry.update(mode)
        else:
            visible = 255
        if self.is_missing:
            writer.case.losses = ["unusable images"]
            return self.add(entry), voxels_of([part], (127, 127, 127))
        seen = {}
        for cell, block in part.blocks.items():
            at = block and tuple(self.wrapped(m, b, image.blocks) for m, b in zip(modes, block))
            seen[cell] = (block and image.colours[at], visible)
        return self.add(entry), seen
