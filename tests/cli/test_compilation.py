"""The first run after an installation says that it compiles."""

import numba

from tusqh.cli.compilation import MESSAGE, announced


def test_compiling_is_said_once_and_only_where_it_happens():
    said = []
    first, second = (numba.njit(lambda x, k=k: x + k) for k in range(2))
    with announced(said.append):
        assert said == []
        first(1)
        second(1)
    assert said == [MESSAGE]
    with announced(said.append):
        first(2)
    assert said == [MESSAGE]
