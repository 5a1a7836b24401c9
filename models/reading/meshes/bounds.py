"""What a mesh file may have at most: more is no spacecraft, or would fill the memory."""

from __future__ import annotations

from models.reading.regular_file import MEGABYTE

MOST_MESH_BYTES = 256 * MEGABYTE
MOST_TEXT_MESH_BYTES = 128 * MEGABYTE  # OBJ, and STL and PLY written as text
MOST_VERTICES = 5_000_000
MOST_FACES = 5_000_000
MOST_NODES = 20_000
MOST_IMAGES = 256
MOST_IMAGE_SIDE_PX = 16_384
MOST_IMAGES_PX = 150_000_000  # of all together
