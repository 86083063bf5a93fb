import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from groundwalk.blas import one_blas_thread


def threads():
    return {
        one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"
    }


@pytest.fixture(autouse=True)
def two_threads():
    """Also where there is one core only."""
    with threadpool_limits(2, user_api="blas"):
        yield


def test_blas_has_one_thread_inside_and_what_it_had_outside():
    assert threads() == {2}
    assert one_blas_thread(threads)() == {1}
    assert threads() == {2}


def test_it_has_what_it_had_after_an_error_too():
    @one_blas_thread
    def fail():
        raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert threads() == {2}
