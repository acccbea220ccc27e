"""Programs that measure; nothing in here is asserted, nothing runs with the tests."""
