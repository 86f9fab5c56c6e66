import base64
import gzip

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from tusqh.explorer.encode import TYPES, pack, smallest_unsigned


def unpack(packed):
    """Read a block as a browser does: typed arrays over one buffer."""
    block = gzip.decompress(base64.b64decode(packed.text))
    out = {}
    for entry in packed.manifest:
        dtype = np.dtype(entry["type"]).newbyteorder("<")
        assert entry["offset"] % dtype.itemsize == 0  # Otherwise a typed array throws an error.
        out[entry["name"]] = np.frombuffer(block, dtype, entry["length"], entry["offset"])
    return out


some_array = st.sampled_from(TYPES).flatmap(
    lambda name: arrays.arrays(name, arrays.array_shapes(min_dims=1, max_dims=2, min_side=0))
)


@given(st.dictionaries(st.text(max_size=5), some_array, max_size=4))
def test_arrays_come_back(given_arrays):
    found = unpack(pack(given_arrays))
    assert list(found) == list(given_arrays)
    for name, array in given_arrays.items():
        np.testing.assert_array_equal(found[name], array.ravel())


def test_the_same_arrays_give_the_same_bytes():
    array = np.arange(1000, dtype=np.uint16)
    text = pack({"a": array}).text
    assert text == pack({"a": array.copy()}).text
    assert base64.b64decode(text)[4:8] == bytes(4)  # The header has no time.


def test_big_endian_arrays_are_turned():
    array = np.arange(5, dtype=">u4")
    np.testing.assert_array_equal(unpack(pack({"a": array}))["a"], array)


@pytest.mark.parametrize("dtype", [np.int64, np.float64, np.bool_])
def test_types_that_browsers_lack_are_refused(dtype):
    with pytest.raises(ValueError, match=r"field is .*, not one of uint8"):
        pack({"field": np.zeros(3, dtype=dtype)})


@pytest.mark.parametrize(("top", "name"), [(255, "uint8"), (256, "uint16"), (65536, "uint32")])
def test_the_smallest_type_holds_the_largest_number(top, name):
    assert smallest_unsigned(np.array([top])).dtype.name == name
    assert int(smallest_unsigned(np.array([top]))[0]) == top
