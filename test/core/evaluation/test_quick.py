"""The shipped weights repeat a row of Table 2 on the shipped validation scenes."""

from reflest_core.cli.main import main
from reflest_core.evaluation.quick_set import EXPECTED, QUICK_SET


def test_a_row_of_table_2_is_reproduced_from_what_is_shipped(capsys):
    assert main(["evaluate", "--quick"]) == 0
    assert "HemiCNN, RMSE_1" in capsys.readouterr().out


def test_the_quick_set_is_small_and_shipped_with_what_it_must_give():
    assert QUICK_SET.stat().st_size < 6_000_000
    assert EXPECTED.is_file()
