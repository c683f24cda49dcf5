"""Messages of FMUs of FMI 2.0 are texts by the time that Python gets them, also where fmpy has no proxy."""

import ctypes

import pytest
from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from rockshed.core.fmu import logger

SAY = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p]


@pytest.fixture
def said(monkeypatch):
    """Call the logger of callbacks as an FMU does; what Python has heard."""
    monkeypatch.setattr(logger, "_proxy_of_fmpy", lambda: None)  # as on ARM under Linux
    heard = []
    callbacks = fmi2CallbackFunctions()
    hear = fmi2CallbackLoggerTYPE(lambda *words: heard.append(words))
    logger.set_logger(callbacks, hear)

    def call(text, *values):
        kinds = [*SAY, *(type(value) for value in values)]
        say = ctypes.CFUNCTYPE(None, *kinds)(ctypes.cast(callbacks.logger, ctypes.c_void_p).value)
        say(7, b"rock", 3, b"error", text, *values)
        return heard.pop()

    return call


def test_a_message_has_its_values_in_it(said):
    values = (ctypes.c_char_p(b"mass"), ctypes.c_int(-4), ctypes.c_double(0.1), ctypes.c_long(9))
    assert said(b"%s is %d, %.2f of %ld %%", *values) == (
        7,
        b"rock",
        3,
        b"error",
        b"mass is -4, 0.10 of 9 %",
    )


def test_a_message_with_more_values_than_registers_has_all_of_them(said):
    values = [kind(n) for n in range(10) for kind in (ctypes.c_int, ctypes.c_double)]
    words = b" ".join([b"%d %g"] * 10)
    assert said(words, *values)[4] == b" ".join(b"%d %d" % (n, n) for n in range(10))


def test_a_long_message_is_cut_and_none_is_empty(said):
    assert len(said(b"%s", ctypes.c_char_p(b"x" * 5000))[4]) == logger.LONGEST_TEXT - 1
    assert said(None)[4] == b""
