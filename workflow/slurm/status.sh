#!/usr/bin/env bash
# Tells snakemake how a Slurm job is: one that Slurm ended, for its time or memory, says so itself no more.
state=$(sacct --noheader --allocations --parsable2 --jobs "$1" --format State 2>/dev/null | head -n 1)
case ${state%% *} in
  COMPLETED) echo success ;;
  BOOT_FAIL | CANCELLED | DEADLINE | FAILED | NODE_FAIL | OUT_OF_MEMORY | PREEMPTED | TIMEOUT) echo failed ;;
  *) echo running ;; # not known yet, waiting, or under way
esac
