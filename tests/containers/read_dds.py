"""What Pillow and texture2ddecoder read in DDS files: `python read_dds.py FILE...` prints a JSON list with, for each file,
Pillow's size, mode and texels of the largest level, or its refusal; and of files of blocks the RGBA texels of each level as
texture2ddecoder decodes them. Bytes are in base64. The levels are found here, by the header's own fields."""
import base64
import json
import struct
import sys

import texture2ddecoder
from PIL import Image

# DXGI_FORMAT of blocks: their bytes and decoder; -128 to 127 as 0 to 255 where there is no decoder of signed blocks.
BLOCKS = {80: (8, texture2ddecoder.decode_bc4), 83: (16, texture2ddecoder.decode_bc5), 98: (16, texture2ddecoder.decode_bc7)}


def text(data):
    return base64.b64encode(data).decode()


def by_pillow(path):
    try:
        with Image.open(path) as image:
            return {"size": image.size, "mode": image.mode, "texels": text(image.tobytes())}
    except Exception as error:
        return {"refused": f"{type(error).__name__}: {error}"}


def blocks(path):
    with open(path, "rb") as file:
        data = file.read()
    height, width = struct.unpack_from("<2I", data, 12)
    (levels,) = struct.unpack_from("<I", data, 28)
    (dxgi,) = struct.unpack_from("<I", data, 128)
    if dxgi not in BLOCKS:
        return None
    block_bytes, decode = BLOCKS[dxgi]
    at, found = 148, []
    for level in range(levels):
        w, h = max(1, width >> level), max(1, height >> level)
        size = -(-w // 4) * -(-h // 4) * block_bytes
        bgra = bytearray(decode(data[at : at + size], w, h))
        bgra[0::4], bgra[2::4] = bgra[2::4], bgra[0::4]
        found.append(text(bytes(bgra)))
        at += size
    return found


print(json.dumps([{"pillow": by_pillow(path), "blocks": blocks(path)} for path in sys.argv[1:]]))
