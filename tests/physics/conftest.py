"""Limits are checked in a module of their own: let its assertions explain themselves too."""

import pytest

pytest.register_assert_rewrite("effect_limits")
