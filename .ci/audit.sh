#!/usr/bin/env bash
# Licences, bans, sources and duplicates by cargo-deny, and dependencies that nothing uses by cargo-machete:
#
#     cargo install --locked cargo-deny cargo-machete; .ci/audit.sh
#
# Building the two takes time that CI has not. Where they are missing this says so, and tests/house/dependencies.rs has
# held the same rules.
set -euo pipefail
cd "$(dirname "$0")/.."

if cargo deny --version >/dev/null 2>&1; then
    cargo deny --log-level error check licenses bans sources
else
    echo "cargo-deny is not installed: licences, bans, sources and duplicates by tests/house/dependencies.rs alone"
fi
if cargo machete --version >/dev/null 2>&1; then
    cargo machete
else
    echo "cargo-machete is not installed: unused dependencies by tests/house/dependencies.rs alone"
fi
