"""The Python on the pages works; tests/journeys types the commands."""

import ast

import pytest
from typed_pages import PAGES, blocks

LONG = ("tune_gait(", "run_diagnosis(", "GroundingStep(")
"""What no test waits for: the examples' tests do it in a small size."""


OF_A_RUN = {"corrected_laws"}
"""Modules that commands of a page write, after which tests/journeys runs its Python."""


PYTHON = [(page, code) for page in PAGES for code in blocks(page, "python")]


@pytest.mark.parametrize(("page", "code"), PYTHON)
def test_python_in_the_pages_works(page, code, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    if not any(call in code for call in LONG) and page.stem in ("README", "python"):
        exec(compile(code, page.name, "exec"), {"__name__": "a_page"})
        return
    imports = (ast.Import, ast.ImportFrom)
    lines = [line for line in ast.parse(code).body if isinstance(line, imports)]
    lines = [line for line in lines if getattr(line, "module", "") not in OF_A_RUN]
    exec(compile(ast.Module(lines, []), page.name, "exec"), {})
