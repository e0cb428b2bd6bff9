"""The one exception of rfsmooth's own."""

import re

_PLACE = re.compile(r"\b(?:line|byte|point|vertex|face|edge) \d+\b")


def _as_python(message):
    """Options as they are written here: --push-alpha and `push-alpha` become push_alpha."""
    return re.sub(r"`([a-z][a-z-]*)`|--([a-z][a-z-]*)", lambda m: (m[1] or m[2]).replace("-", "_"), message)


class Error(Exception):
    """What could not be done with the data, the file or the options.

    code: "usage", "input_unreadable", "no_usable_points", "cannot_write", "out_of_memory", "not_installed",
        "cancelled" or "internal" (a bug of rfsmooth's).
    place: where, as "line 12", "byte 300" or "point 7"; None if it has no place.
    """

    code: str
    place: "str | None"

    def __init__(self, code, message):
        super().__init__(_as_python(message))
        self.code = code
        found = _PLACE.search(message)
        self.place = found[0] if found else None

    def __reduce__(self):
        return type(self), (self.code, str(self))
