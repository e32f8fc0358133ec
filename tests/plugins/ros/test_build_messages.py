"""The sources of message packages, and what the command says where it cannot build them."""

import re

import pytest

from harness.plugins.ros.build_messages import ORDER, interfaces_of, main, write_sources


@pytest.mark.parametrize("package", ORDER)
def test_sources_name_every_package_that_their_fields_are_of(package, tmp_path):
    write_sources(package, tmp_path)
    cmake = (tmp_path / "CMakeLists.txt").read_text()
    files = interfaces_of(package)
    assert files
    for name in files:
        text = (tmp_path / name).read_text()
        assert name in cmake
        assert "structure_needs_at_least_one_member" not in text
        for used in {*re.findall(r"^([a-z_0-9]+)/", text, flags=re.MULTILINE)} - {package}:
            assert f"find_package({used} REQUIRED)" in cmake
            assert used not in ORDER or ORDER.index(used) < ORDER.index(package)


@pytest.mark.parametrize("words", [[], ["nowhere"], ["nowhere", "moveit_msgs"]])
def test_a_folder_without_rclpy_is_answered_with_what_to_install(words, capsys):
    assert main(words) == 2
    assert "pip install ros-rclpy" in capsys.readouterr().out
