"""Runs functions with BLAS limited to one thread, for reproducible results."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

Given = ParamSpec("Given")
Result = TypeVar("Result")


def one_blas_thread(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Decorator: run a function with BLAS on one thread, whatever the number of cores.

    The order in which BLAS adds numbers depends on its number of threads, and with it
    the last bits of a sum, so that a fit or a search may end at other values. The limit
    applies to BLAS libraries that are already loaded when the function is called.
    """

    @wraps(function)
    def limited(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited
