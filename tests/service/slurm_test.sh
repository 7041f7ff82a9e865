#!/bin/bash
# A campaign on a real Slurm: a cluster of this one machine, made for the test; an array of three
# tasks, one of which is killed half-way and put back; and the merged shards against what one
# process gives, byte for byte.
#
#   slurm_test.sh FOREWALK FOREWALK-ARRAY.SH ASSETS
#
# Needs slurm-wlm and root; exits with 77 and says why where these are missing.
set -u

forewalk=$1
script=$2
assets=$3

skip() {
  echo "skipped: $1"
  exit 77
}

for program in slurmctld slurmd sbatch scontrol squeue scancel; do
  command -v "$program" >/dev/null || skip "there is no $program here (Debian: slurm-wlm)"
done
[ "$(id -u)" -eq 0 ] || skip "slurmctld and slurmd need root"

work=$(mktemp -d -t forewalk-slurm-XXXXXX)
controller=
node=
finish() {
  scancel --quiet --user=root 2>/dev/null
  for daemon in $node $controller; do kill "$daemon" 2>/dev/null && wait "$daemon" 2>/dev/null; done
  rm -rf "$work"
}
trap finish EXIT

fail() {
  echo "slurm_test.sh: $1" >&2
  tail -n 15 "$work"/*.log >&2
  exit 1
}

# --- The cluster ---

export SLURM_CONF=$work/slurm.conf
host=$(hostname -s)
port=$((20000 + $$ % 10000))
mkdir "$work/state" "$work/spool"
cat >"$SLURM_CONF" <<CONF
ClusterName=forewalk
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 10000))
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
AuthInfo=cred_expire=5
CredType=cred/none
MpiDefault=none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=1,bf_interval=1,requeue_delay=0
JobRequeue=1
MinJobAge=300
KillWait=2
ReturnToService=2
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
slurmctld -D >/dev/null 2>&1 &
controller=$!
slurmd -D -N "$host" >/dev/null 2>&1 &
node=$!
for _ in $(seq 300); do
  sinfo --noheader --format=%T 2>/dev/null | grep -q '^idle' && break
  sleep 0.1
done
# Not ours to mend: a machine that forbids what slurmd needs (cgroups, a host name that resolves).
if ! sinfo --noheader --format=%T 2>/dev/null | grep -q '^idle'; then
  echo "skipped: slurmd does not come up on this machine: $(tail -n 2 "$work/slurmd.log" "$work/slurmctld.log" 2>&1)"
  exit 77
fi

# --- The campaign ---

cp "$assets/scenes/corridor.obj" "$work"
cat >"$work/plan.json" <<'PLAN'
{"format": "forewalk.experiment/1", "name": "on a cluster",
 "walk": {"limits": "toolkit", "horizon_m": 8, "rate_hz": 60, "stop": {"virtual_m": 300}},
 "scenes": ["corridor.obj"], "users": [{"name": "visitor", "kind": "wander"}],
 "rooms": [{"name": "4 m", "rectangle": [4, 4]}, {"name": "5 m", "rectangle": [5, 5]}],
 "controllers": ["none", "s2c-predictive"], "seeds": 12}
PLAN
"$forewalk" experiment "$work/plan.json" --out "$work/whole" >"$work/whole.log" 2>&1 ||
  fail "one process alone fails"

cd "$work" || exit 1
export FOREWALK=$forewalk
job=$(sbatch --parsable --array=1-3 "$script" plan.json shards) || fail "sbatch refuses the array"

# Killed in the middle of its work, without a warning: what ends a node's life.
rows=$work/shards/shard-2/rows.jsonl
for _ in $(seq 1200); do
  [ -s "$rows" ] && break
  sleep 0.05
done
[ -s "$rows" ] || fail "task 2 does not begin"
raw=$(scontrol show job "${job}_2" | sed -n 's/^JobId=\([0-9]*\).*/\1/p' | head -n 1)
# shellcheck disable=SC2046 # a number each
kill -KILL $(scontrol listpids "$raw" | awk 'NR > 1 && $1 > 0 { print $1 }') ||
  fail "task 2 cannot be killed"
stateOf() { scontrol show job "$1" 2>/dev/null | sed -n 's/.*JobState=\([A-Z_]*\).*/\1/p' | head -n 1; }
for _ in $(seq 100); do
  case $(stateOf "${job}_2") in RUNNING | COMPLETING) sleep 0.1 ;; *) break ;; esac
done
[ "$(stateOf "${job}_2")" = FAILED ] || fail "task 2 is $(stateOf "${job}_2") after it was killed"
before=$(wc -l <"$rows")
echo "task 2 was killed after $before of 16 runs"
[ "$before" -lt 16 ] || fail "task 2 was done before it was killed"

# Shards that are not whole are refused.
"$forewalk" merge shards/shard-2 --out merged >"$work/merge.log" 2>&1 && fail "a part was merged"
[ ! -e merged ] || fail "a refused merge left something behind"

scontrol requeue "${job}_2" || fail "task 2 cannot be put back"
for _ in $(seq 1500); do
  [ -z "$(squeue --noheader --jobs "$job" 2>/dev/null)" ] && break
  sleep 0.1
done
[ -z "$(squeue --noheader --jobs "$job")" ] || fail "the array does not end: $(squeue --jobs "$job")"
for task in 1 2 3; do
  [ "$(stateOf "${job}_$task")" = COMPLETED ] || fail "task $task is $(stateOf "${job}_$task")"
done
grep -q "$before of them before" "$work/forewalk-${job}_2.log" ||
  fail "task 2 did not go on where it was"

"$forewalk" merge shards/shard-1 shards/shard-2 shards/shard-3 --out merged >"$work/merge.log" 2>&1 ||
  fail "the shards cannot be merged"
for file in manifest.json results.csv results.json openrdw.csv; do
  cmp "whole/$file" "merged/$file" || fail "$file differs"
done
diff -r whole/traces merged/traces >/dev/null || fail "traces differ"
echo "48 runs by three tasks, one killed and put back: the bytes of one process"
