"""Runs functions with BLAS limited to one thread, for reproducible results."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

Given = ParamSpec("Given")
Result = TypeVar("Result")


def one_blas_thread(function: Callable[Given, Result]) -> Callable[Given, Result]:
    """Make a function whose result does not depend on the number of cores.

    Several BLAS threads add numbers in another order, so that a fit or a search may end
    at other values. The limit applies to libraries that are loaded when the function
    is called.

    Args:
      function: any function.

    Returns:
      A function with the same arguments and result.
    """

    @wraps(function)
    def limited(*args: Given.args, **kwargs: Given.kwargs) -> Result:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*args, **kwargs)

    return limited
