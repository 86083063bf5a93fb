"""The chi-squared distribution, compared with SciPy's statistics."""

import pytest
from scipy.stats import chi2

from groundwalk import chi_squared

FREEDOMS = 1, 2, 7.5, 300


@pytest.mark.parametrize("freedom", FREEDOMS)
@pytest.mark.parametrize("chance", [1e-9, 0.01, 0.5, 0.999])
def test_it_is_that_of_scipy_to_the_bit(freedom, chance):
    value = chi_squared.exceeded(chance, freedom)
    assert value == chi2.isf(chance, freedom)
    assert chi_squared.chance_above(value, freedom) == chi2.sf(value, freedom)
    assert chi_squared.quantile(chance, freedom) == chi2.ppf(chance, freedom)


def test_what_is_less_likely_is_larger():
    assert chi_squared.exceeded(0.01, 3) > chi_squared.exceeded(0.1, 3)
    assert chi_squared.quantile(0.9, 3) == pytest.approx(chi_squared.exceeded(0.1, 3))
