"""Tails and quantiles are those of `scipy.stats`, which is slow to import."""

import subprocess
import sys

import numpy as np
import pytest
from scipy.stats import chi2, f, norm, t

from groundwalk.distributions import (
    chi2_isf,
    chi2_ppf,
    chi2_sf,
    f_sf,
    normal_ppf,
    t_ppf,
    t_sf,
)

FREEDOMS = (0.5, 1, 2, 7.3, 1000)
SHARES = (1e-6, 0.01, 0.5, 0.9, 0.9999)


@pytest.mark.parametrize("freedom", FREEDOMS)
def test_chi_square(freedom: float) -> None:
    for share in SHARES:
        value = chi2.ppf(share, freedom)
        assert chi2_ppf(share, freedom) == pytest.approx(value, rel=1e-9)
        assert chi2_isf(share, freedom) == pytest.approx(chi2.isf(share, freedom))
        assert chi2_sf(value, freedom) == pytest.approx(1 - share)


def test_chi_square_of_several_freedoms() -> None:
    freedom = np.array([1, 3])
    assert np.allclose(chi2_isf(0.01, freedom), chi2.isf(0.01, freedom))


@pytest.mark.parametrize("freedom", FREEDOMS)
def test_student(freedom: float) -> None:
    for share in SHARES:
        value = t.ppf(share, freedom)
        assert t_ppf(share, freedom) == pytest.approx(value, rel=1e-6)
        assert t_sf(value, freedom) == pytest.approx(1 - share, rel=1e-6)


def test_ratios_of_variances_and_the_normal_distribution() -> None:
    assert f_sf(2.5, 3, 8) == pytest.approx(f.sf(2.5, 3, 8))
    assert f_sf(2.5, 3, 8) != pytest.approx(f.sf(2.5, 8, 3))
    for share in SHARES:
        assert normal_ppf(share) == pytest.approx(norm.ppf(share), rel=1e-9)


def test_nothing_is_known_without_freedom() -> None:
    assert np.isnan(
        [chi2_sf(1.0, 0), f_sf(1.0, 0, 2), t_sf(1.0, 0), t_ppf(0.9, 0)]
    ).all()


def test_a_diagnosis_does_not_import_scipy_stats() -> None:
    code = (
        "import sys, diagnosis, diagnosis.check, experiments.check\n"
        "print('scipy.stats' in sys.modules, 'scipy.special' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["False", "True"]
