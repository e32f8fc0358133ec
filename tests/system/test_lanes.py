"""Parameters of nightly tests that are part of the default run."""

import pytest

CODE = """
import pytest

@pytest.mark.nightly({})
@pytest.mark.parametrize("name", ["a", "b", "c"])
def test(name): pass
"""


@pytest.fixture
def outcomes(pytester):
    """Outcomes of the default and of the nightly run of one test with three parameters."""

    def run(arguments):
        pytester.makepyfile(CODE.format(arguments))
        pytester.makeini("[pytest]\nmarkers = nightly")
        found = []
        for lane in ("not nightly", "nightly"):
            counted = pytester.runpytest("-p", "tests.lanes", "-m", lane).parseoutcomes()
            counted.pop("warnings", None)  # of modules that other tests have imported
            found.append(counted)
        return found

    return run


@pytest.mark.nightly(but=[0])
@pytest.mark.parametrize("arguments", ["but=['b']", "only=['a', 'c']", "but=[1]"])
def test_the_default_run_has_what_the_nightly_run_leaves_out(outcomes, arguments):
    default, nightly = outcomes(arguments)
    assert default == {"passed": 1, "deselected": 2}
    assert nightly == {"passed": 2, "deselected": 1}


def test_without_names_all_parameters_are_nightly(outcomes):
    assert outcomes("") == [{"deselected": 3}, {"passed": 3}]


def test_a_name_that_no_parameter_has_is_a_usage_error(pytester):
    pytester.makepyfile(CODE.format("but=['d']"))
    pytester.makeini("[pytest]\nmarkers = nightly")
    result = pytester.runpytest("-p", "tests.lanes")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["*::test has no parameters {'d'}"])
