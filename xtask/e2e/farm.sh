#!/usr/bin/env bash
# A real Slurm on this machine with four workers: a picture in four shares by the scripts of examples/cluster, one worker
# killed midway, its share submitted again, and the same bytes as one process with one thread makes alone; and a film in three runs
# of frames.
# Usage: farm.sh RTC ROOT, in an empty folder. Needs munged, slurmctld, slurmd and sbatch, and root, as which they run.
set -euo pipefail
export PATH=$PATH:/usr/sbin
rtc=$1
root=$2
desk=$PWD
scripts=$root/examples/cluster
# The key's folder has to be safe from others, and sockets want short paths.
state=$(mktemp -d /tmp/rtc-farm-XXXXXX)
chmod 755 "$state"
pids=()

finish() {
  code=$?
  set +e
  # Jobs first: their processes are nobody's children here.
  [ -n "${SLURM_CONF:-}" ] && timeout 20 scancel --quiet --user=$(id -un) 2>/dev/null
  sleep 1
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null; done
  sleep 1
  for pid in "${pids[@]}"; do kill -9 "$pid" 2>/dev/null; done
  if [ "$code" != 0 ]; then
    tail -n 20 "$state"/*.log "$desk"/*.log 2>/dev/null
  fi
  rm -rf "$state"
  exit "$code"
}
trap finish EXIT

wait_for() { # SECONDS WHAT COMMAND…
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@" >/dev/null 2>&1; do
    if [ "$SECONDS" -ge "$deadline" ]; then
      echo "waited in vain: $what"
      exit 1
    fi
    sleep 0.2
  done
}

# Who may speak to whom: a key, and a daemon that signs with it.
dd if=/dev/urandom of="$state/key" bs=128 count=1 status=none
chmod 400 "$state/key"
munged --foreground --force --key-file "$state/key" --socket "$state/munge.socket" --pid-file "$state/munge.pid" \
  --log-file "$state/munge.log" --seed-file "$state/munge.seed" >"$state/munge.out" 2>&1 &
pids+=($!)
wait_for 20 "munged" test -S "$state/munge.socket"

host=$(hostname -s)
cat > "$state/slurm.conf" <<CONF
ClusterName=e2e
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=17800
AuthType=auth/munge
AuthInfo=socket=$state/munge.socket
CredType=cred/munge
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
ProctrackType=proctrack/pgid
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
StateSaveLocation=$state/control
SlurmdSpoolDir=$state/spool-%n
SlurmctldPidFile=$state/control.pid
SlurmdPidFile=$state/%n.pid
SlurmctldLogFile=$state/control.log
SlurmdLogFile=$state/%n.log
MailProg=/bin/true
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,sched_interval=2
NodeName=w[1-4] NodeHostname=$host NodeAddr=127.0.0.1 Port=[17801-17804] CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
export SLURM_CONF=$state/slurm.conf
mkdir "$state/control"
slurmctld -D >"$state/control.out" 2>&1 &
pids+=($!)
declare -A daemon
for worker in w1 w2 w3 w4; do
  mkdir "$state/spool-$worker"
  slurmd -D -N "$worker" >"$state/$worker.out" 2>&1 &
  daemon[$worker]=$!
  pids+=($!)
done
idle() { [ "$(sinfo --noheader --format=%D --states=idle)" = 4 ]; }
wait_for 60 "four idle workers" idle

scene=$root/examples/three-balls.rt
flags=(--size 160x120 --samples 1200)
export RTC=$rtc

array=$(sbatch --parsable --array=1-4 --output="$desk/share-%a.log" \
  "$scripts/shares.sbatch" "$scene" parts "${flags[@]}" --checkpoint-every 1s)
echo "  four shares are job $array"

# One worker is lost in the middle of its share: its daemon, the step's, and what runs under it.
wait_for 120 "a checkpoint of share 2" test -s parts/2.exr.checkpoint
worker=$(squeue --noheader --format=%N --job="${array}_2")
step=$(pgrep --full "slurmstepd: \[$(squeue --noheader --format=%A --job="${array}_2").batch\]")
lost=$(pgrep --full -- "--shard auto -o parts/2.exr" | head -n 1)
kill -9 "${daemon[$worker]}" "$step" "$lost"
[ ! -e parts/2.exr ] || { echo "share 2 was done before its worker was lost"; exit 1; }
echo "  worker $worker is lost in the middle of share 2"

# Whoever makes it again goes on from its checkpoint: asked for another picture, the same script refuses to.
if SHARES=4 SLURM_ARRAY_TASK_ID=2 "$scripts/shares.sbatch" "$scene" parts "${flags[@]}" --seed 7 2>"$desk/other.log"; then
  echo "the lost share would begin afresh"
  exit 1
fi
grep -q 'cannot go on from' "$desk/other.log" && grep -q 'its seed' "$desk/other.log" || { cat "$desk/other.log"; exit 1; }

# Its share once more, on another; the merge when all are there.
scancel "${array}_2"
again=$(SHARES=4 sbatch --parsable --array=2 --exclude="$worker" --output="$desk/share-again.log" \
  "$scripts/shares.sbatch" "$scene" parts "${flags[@]}")
merge=$(sbatch --parsable --dependency="afterok:$again,afterok:${array}_1,afterok:${array}_3,afterok:${array}_4" \
  --output="$desk/merge.log" "$scripts/merge.sbatch" parts all.exr)
looked() { "$rtc" merge --partial parts/*.exr -o look.png; }
wait_for 300 "a first share to look at" looked
gone() { [ -z "$(squeue --noheader --job="$1" 2>/dev/null)" ]; }
wait_for 400 "the merge, job $merge" gone "$merge"
sed 's/^/  /' "$desk/merge.log"

"$rtc" build "$scene" "${flags[@]}" -j 1 -o one.exr --quiet
cmp one.exr all.exr
echo "  the same bytes as one process with one thread makes alone"

# The line of the Kubernetes job, as a pod runs it.
mkdir pods
cp "$scene" pods/scene.rt
line=$(python3 - "$scripts/kubernetes.yaml" <<'PYTHON'
import re, sys
text = open(sys.argv[1]).read()
print(" ".join(re.search(r"- >-\n((?: {14,}.*\n)+)", text).group(1).split()))
PYTHON
)
line=${line/exec rtc/exec \"\$RTC\"}
line=${line/--samples 1024/--samples 16 --size 80x60}
for index in 0 1 2 3 4 5 6 7; do
  (cd pods && JOB_COMPLETION_INDEX=$index sh -c "$line" 2>"$desk/pod.log") || { cat "$desk/pod.log"; exit 1; }
done
"$rtc" merge pods/parts/*.exr -o pods/all.exr --quiet
"$rtc" build pods/scene.rt --samples 16 --size 80x60 -o pods/one.exr -j 1 --quiet
cmp pods/one.exr pods/all.exr
echo "  eight pods, to the same bytes"

# A film by runs of its frames; whoever puts it together makes none of them again.
film=("$root/examples/turntable.rt" --frames 7 --sweep "angle = 0deg until 360deg" --size 80x60 --samples 8)
runs=$(sbatch --parsable --array=1-3 --exclude="$worker" --output="$desk/frames-%a.log" \
  "$scripts/frames.sbatch" "${film[0]}" 7 frames "${film[@]:3}")
wait_for 300 "the frames, job $runs" gone "$runs"
"$rtc" build "${film[@]}" -o 'frames/{06}.exr' --resume -o farm.webp 2>film.log
[ "$(grep -c 'is done' film.log)" = 7 ] || { echo "not all frames were done"; cat film.log; exit 1; }
"$rtc" build "${film[@]}" -o one.webp -j 1 --quiet
cmp one.webp farm.webp
echo "  a film of seven frames in three runs, to the same bytes"
