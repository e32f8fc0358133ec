"""Numbers for people, under the name by which expectations imported them."""

from harness.core.amounts import amount as amount
from harness.core.amounts import amounts as amounts
from harness.core.amounts import percentages as percentages
