import math

import pytest

from groundwalk.errors import BadValueError, UnknownNameError
from robots.servos.types import servo_of, servo_types

RPM = 2 * math.pi / 60


@pytest.mark.parametrize(
    ("text", "stall_nm", "no_load_rad_s"),
    [
        ("xl430-w250@11.1V", 1.4, 57 * RPM),
        ("xl430-w250@9V", 1.0, 47 * RPM),
        ("mx-106@12V", 8.4, 45 * RPM),
        ("xl330-m288@5V", 0.52, 103 * RPM),
    ],
)
def test_stall_and_no_load_are_about_those_of_the_maker(text, stall_nm, no_load_rad_s):
    # what benches measured differs from what makers state by up to a quarter
    servo = servo_of(text)
    assert servo.max_torque_nm == pytest.approx(stall_nm, rel=0.15)
    speed_rad_s = servo.max_torque_nm / servo.back_emf_nm_s_rad
    assert speed_rad_s == pytest.approx(no_load_rad_s, rel=0.27)


def test_a_servo_is_a_motor_behind_a_duty_cycle():
    # kt = 1.622 N m/A, R = 3.949 ohm; 0.158 of full duty for a radian and unit of P
    servo = servo_of("mx-64@12V,P=32")
    assert servo.kp_nm_rad == pytest.approx(32 * 0.158 * 12 * 1.622 / 3.949)
    assert servo.back_emf_nm_s_rad == pytest.approx(1.622**2 / 3.949)
    assert servo.max_torque_nm == pytest.approx(0.9625 * 12 * 1.622 / 3.949)
    assert servo.rotor_kg_m2 == 0.01195


def test_supply_and_gain_scale_the_stiffness():
    usual, weak = servo_of("sts3215"), servo_of("STS3215@7.4v,p=16")
    assert weak.kp_nm_rad == pytest.approx(usual.kp_nm_rad / 2)
    low = servo_of("sts3215@6.0V")
    assert low.kp_nm_rad == pytest.approx(usual.kp_nm_rad * 6.0 / 7.4)
    assert low.back_emf_nm_s_rad == usual.back_emf_nm_s_rad


def test_each_supply_has_its_own_motor():
    assert servo_of("sts3215@12V").rotor_kg_m2 != servo_of("sts3215").rotor_kg_m2


def test_what_cannot_be_is_refused():
    with pytest.raises(UnknownNameError, match="did you mean 'sts3215'"):
        servo_of("sts3251")
    with pytest.raises(BadValueError, match=r"4 to 8\.4 or 9 to 12\.6 V"):
        servo_of("sts3215@24V")
    for text in ("", "sts3215@", "sts3215@7.4", "sts3215@7.4V,P=", "sts3215@1e9V"):
        with pytest.raises(BadValueError, match="such as sts3215@"):
            servo_of(text)


def test_every_type_works_at_its_usual_supply_and_says_where_it_is_from():
    for name, variants in servo_types().items():
        for one in variants:
            assert one.volts[0] <= one.usual_volts <= one.volts[1], name
            assert len(one.source) > 20, name
