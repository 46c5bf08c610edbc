"""What the 3D Tiles Archive Format 1.3 asks of a .3tz file, read from its bytes with Python's library alone: the ZIP file, and the index by which a
file is found without the directory of the ZIP file."""
import hashlib
import pathlib
import struct
import zipfile

from json_place import Place

INDEX = "@3dtilesIndex1@"
LOCAL = struct.Struct("<4s5H3I2H")  # signature, version, flags, method, time, date, checksum, sizes, lengths of the name and of what follows it
ENTRY = struct.Struct("<QQQ")


class Archive:
    """Checked, or Wrong. `names` are those of its files; `index` has three numbers an entry: the hash's halves and an offset."""

    def __init__(self, path):
        self.data = pathlib.Path(path).read_bytes()
        place = self.place = Place(None, pathlib.Path(path).name)
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            place.require(archive.testzip() is None, "has a wrong checksum")
            place.require(archive.comment == b"" and not any(entry.comment for entry in entries), "has a comment")
        names = [entry.filename for entry in entries]
        place.require(len(set(names)) == len(names), "has an entry twice")
        place.require("tileset.json" in names, "has no tileset.json")
        place.require(names[-1] == INDEX and entries[-1].compress_type == zipfile.ZIP_STORED, "does not end in a stored index")
        place.require(not any(".3tz" in name or name.startswith("/") or "\\" in name for name in names), "has a name that none may have")
        for entry in entries:
            header = self.header(entry.header_offset)
            place.require(header == (entry.filename, entry.CRC, entry.compress_size, entry.file_size), f"has another local header for {entry.filename}")
        self.names = names[:-1]
        index, _ = self.content(entries[-1].header_offset)
        place.require(len(index) == ENTRY.size * len(self.names), "has an index of another length")
        self.index = [ENTRY.unpack_from(index, at) for at in range(0, len(index), ENTRY.size)]
        place.require(self.index == sorted(self.index), "has an index that is not sorted")
        for entry in entries[:-1]:
            place.require(self.find(entry.filename) == entry.header_offset, f"does not have {entry.filename} in its index")

    def header(self, offset):
        """Name, checksum and sizes by the local header."""
        self.place.require(offset + LOCAL.size <= len(self.data), f"names offset {offset}, behind its end")
        signature, _, flags, _, _, _, crc, packed, size, name, _ = LOCAL.unpack_from(self.data, offset)
        self.place.require((signature, flags & ~0x800) == (b"PK\3\4", 0), f"has no local header at {offset}, or one without sizes")
        at = offset + LOCAL.size
        return self.data[at:at + name].decode(), crc, packed, size

    def content(self, offset):
        """The bytes of a stored entry, and its name."""
        _, _, _, method, _, _, _, _, size, name, extra = LOCAL.unpack_from(self.data, offset)
        self.place.require(method == 0, f"has an entry at {offset} that is not stored")
        at = offset + LOCAL.size
        return self.data[at + name + extra:at + name + extra + size], self.data[at:at + name].decode()

    def find(self, name):
        """The offset of a local header by binary search as the specification describes it; None where there is none of the name."""
        sought = struct.unpack("<QQ", hashlib.md5(name.encode()).digest())
        low, high = 0, len(self.index)
        while low < high:
            middle = (low + high) // 2
            if self.index[middle][:2] < sought:
                low = middle + 1
            else:
                high = middle
        for first, second, offset in self.index[low:]:
            if (first, second) != sought:
                return None
            if self.header(offset)[0] == name:
                return offset
        return None

    def read(self, name):
        return self.content(self.find(name))[0]
