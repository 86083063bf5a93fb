import numpy as np
import pytest
from threadpoolctl import threadpool_info

from groundwalk.blas import one_blas_thread


def threads():
    np.linalg.inv(np.eye(2))
    return {
        one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"
    }


def test_blas_has_one_thread_inside_and_what_it_had_outside():
    before = threads()
    assert one_blas_thread(threads)() == {1}
    assert threads() == before


def test_it_is_so_after_an_error_too():
    before = threads()

    @one_blas_thread
    def fail():
        raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert threads() == before
