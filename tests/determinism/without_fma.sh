#!/usr/bin/env bash
# The probe's hashes where glibc takes its code without AVX2 and FMA, as on an older processor: those that are kept. That this
# is in force is seen by libm's own results, which change; where the processor has no FMA, they cannot.
#   without_fma.sh PROBE HASHES
set -euo pipefail
probe=$1
kept=$2
without=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4
here=$("$probe" --libm)
there=$(GLIBC_TUNABLES=$without "$probe" --libm)
echo "libm as it is here:"
echo "$here"
echo "libm without AVX2 and FMA:"
echo "$there"
if grep -qw fma /proc/cpuinfo && [ "$(grep doubles <<<"$here")" = "$(grep doubles <<<"$there")" ]; then
  echo "GLIBC_TUNABLES does not reach libm: nothing would be tested"
  exit 1
fi
# Bullet asks libm for sines in single precision: of all of these, none may differ.
[ "$(grep floats <<<"$here")" = "$(grep floats <<<"$there")" ] || { echo "Bullet's sines differ"; exit 1; }
GLIBC_TUNABLES=$without "$probe" --expect "$kept"
