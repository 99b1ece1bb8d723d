#!/usr/bin/env bash
# A real Slurm on this machine with five workers: a picture in four shares by the very lines of examples/cluster/README.md. One
# worker is killed midway, one task put back into the queue, one cancelled and asked for again, one ended by its time; and the picture
# has the same bytes as one process with one thread makes alone. And a film in three runs of frames.
# Usage: farm.sh RTC ROOT, in an empty folder. Needs munged, slurmctld, slurmd and sbatch, and root, as which they run.
# Whatever fails, in functions and `$(…)` too, ends all of it, and is named by the trap below.
set -Eeuo pipefail
shopt -s inherit_errexit
export PATH=$PATH:/usr/sbin
rtc=$1
root=$2
desk=$PWD
scripts=$root/examples/cluster
# The key's folder has to be safe from others, and sockets want short paths.
state=$(mktemp -d /tmp/rtc-farm-XXXXXX)
chmod 755 "$state"
pids=()

# What failed is said last, below the logs.
why=
trap 'why="line $LINENO: $BASH_COMMAND"' ERR
fail() { # WHY: said in a file, as a part of the script may be its own process.
  echo "$1" >"$state/why"
  exit 1
}

finish() {
  code=$?
  trap - ERR
  set +e
  # Jobs first: their processes are nobody's children here.
  [ -n "${SLURM_CONF:-}" ] && timeout 20 scancel --quiet --user=$(id -un) 2>/dev/null
  sleep 1
  for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null; done
  sleep 1
  for pid in "${pids[@]}"; do kill -9 "$pid" 2>/dev/null; done
  if [ "$code" != 0 ]; then
    tail -n 20 "$state"/*.log "$desk"/*.log 2>/dev/null
    [ -s "$state/why" ] && why=$(cat "$state/why")
    echo "failed: $why"
  fi
  rm -rf "$state"
  exit "$code"
}
trap finish EXIT

wait_for() { # SECONDS WHAT COMMAND…
  local deadline=$((SECONDS + $1)) what=$2
  shift 2
  until "$@" >/dev/null 2>&1; do
    [ "$SECONDS" -lt "$deadline" ] || fail "waited in vain: $what"
    sleep 0.05
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
# What goes back into the queue is held there for as long as a worker could take it for what it has just ended: else two minutes.
AuthInfo=socket=$state/munge.socket,cred_expire=10
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
# A worker that is gone is soon known to be; what it was at goes back into the queue, as it does by default.
SlurmdTimeout=10
JobRequeue=1
KillWait=30
SchedulerParameters=batch_sched_delay=0,sched_interval=2
NodeName=w[1-5] NodeHostname=$host NodeAddr=127.0.0.1 Port=[17801-17805] CPUs=1 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
export SLURM_CONF=$state/slurm.conf
mkdir "$state/control"
slurmctld -D >"$state/control.out" 2>&1 &
pids+=($!)
declare -A daemon
for worker in w1 w2 w3 w4 w5; do
  mkdir "$state/spool-$worker"
  slurmd -D -N "$worker" >"$state/$worker.out" 2>&1 &
  daemon[$worker]=$!
  pids+=($!)
done
idle() { [ "$(sinfo --noheader --format=%D --states=idle)" = 5 ]; }
wait_for 60 "five idle workers" idle

scene=$root/examples/three-balls.rt
flags=(--size 160x120 --samples 2400)
export RTC=$rtc
export PATH=$(dirname "$rtc"):$PATH
mkdir farm
cp "$scripts"/*.sbatch farm
cp "$scene" farm/room.rt
cat > farm/film.rt <<'SCENE'
param t: number = 0
sphere { radius: 1m, at: (0, t * 1m, 0) }
plane { at: (0, -1, 0)m }
light { at: (2, 4, 3)m, radius: 30cm, power: 90W }
SCENE

# A line of the README that holds these words, as a farm's user copies it, with less to do.
recipe() {
  local line
  line=$(grep -F "$1" "$scripts/README.md" | grep '^sbatch')
  [ "$(wc -l <<<"$line")" = 1 ] || fail "not one line of the README has \`$1\`"
  sed -e 's/1-64/1-4/; s/array=17/array=4/; s/room.rt 64/room.rt 4/; s/--samples 4096/--samples 2400 --size 160x120 --checkpoint-every 16spp/' \
    -e 's/1-16/1-3/; s/480 16 frames/7 3 frames/; s/--frames 480/--frames 7/; s/--samples 256/--samples 8 --size 80x60/g' <<<"$line"
}
submit() { # WORDS: runs the line in the folder, and prints the number of the job that comes last.
  local line said
  line=$(recipe "$1")
  echo "  $line" >&2
  said=$(cd farm && eval "$line")
  echo "${said##* }"
}
numbered() { squeue --noheader --name=rtc-shares --format=%F | sort -n | tail -n 1; }
gone() { [ -z "$(squeue --noheader --job="$1" 2>/dev/null)" ]; }
state() { squeue --noheader --format=%T --array --job="$1"; }

merge=$(submit 'array=1-64 shares.sbatch')
array=$(numbered)
echo "  four shares are job $array, their merge is job $merge"

# Meanwhile, one whose time is up: it is told before, and keeps what it has.
timed=$(sbatch --parsable --array=1 --time=1 --signal=B:USR1@20 --chdir=farm --output="$desk/timed.log" \
  shares.sbatch room.rt 2 timed --size 80x60 --samples 1000000 --checkpoint-every 10h)

(until [ -s farm/timed/1.exr.checkpoint ]; do sleep 0.2; done; state "$timed" >timed.state) &
pids+=($!)

# However fast the machine is, a share that has kept samples waits for what is to happen to it.
process() { pgrep --full -- "--shard auto/4 -o parts/$1.exr" | head -n 1; }
freeze() {
  wait_for 120 "a checkpoint of share $1" test -s "farm/parts/$1.exr.checkpoint"
  kill -STOP "$(process "$1")" || fail "share $1 was done before anything could happen to it"
  [ ! -e "farm/parts/$1.exr" ] || fail "share $1 was done before anything could happen to it"
}
# It finds the signals that came in between.
thaw() {
  sleep 1
  kill -CONT "$1" 2>/dev/null || true
}
# Each as soon as it can be: who waits for one does not see another end.
freezing=()
for share in 2 3 4; do
  freeze "$share" &
  freezing+=($!)
done
for one in "${freezing[@]}"; do wait "$one"; done

# One worker is lost in the middle of its share: its daemon, the step's, and what runs under it.
worker=$(squeue --noheader --format=%N --job="${array}_2")
step=$(pgrep --full "slurmstepd: \[$(squeue --noheader --format=%A --job="${array}_2").batch\]")
kill -9 "${daemon[$worker]}" "$step" "$(process 2)"
echo "  worker $worker is lost in the middle of share 2"

# Whoever makes it again goes on from its checkpoint: asked for another picture, the same script refuses to.
if (cd farm && SLURM_ARRAY_TASK_ID=2 ./shares.sbatch room.rt 4 parts "${flags[@]}" --seed 7 2>"$desk/other.log"); then
  fail "the lost share would begin afresh"
fi
grep -q 'cannot go on from' "$desk/other.log" && grep -q -e '--seed 7` (kept: 0)' "$desk/other.log" ||
  fail "a share with another seed is refused otherwise: $(cat "$desk/other.log")"

# One is preempted: it is asked to end, keeps its samples, and goes back into the queue.
frozen=$(process 3)
scontrol requeue "${array}_3"
thaw "$frozen"
wait_for 60 "share 3 to wait again" grep -q interrupted "farm/slurm-${array}_3.out"
kept=$(sed -n 's/^interrupted; kept \(.*\) in .*/\1/p' "farm/slurm-${array}_3.out")
[ -n "$kept" ] || fail "SIGTERM kept nothing: $(cat "farm/slurm-${array}_3.out")"
echo "  share 3 is put back into the queue with $kept"

# And one is lost for good.
frozen=$(process 4)
scancel "${array}_4"
thaw "$frozen"
wait_for 60 "the end of share 4" grep -q interrupted "farm/slurm-${array}_4.out"

again() { scontrol show job "${array}_$1" | grep -q 'Restarts=1'; }
wait_for 90 "share 2 to be in the queue again" again 2
echo "  Slurm has put share 2 into the queue again by itself"
looked() { (cd farm && "$rtc" merge --partial parts/*.exr -o look.png); }
wait_for 300 "a first share to look at" looked
wait_for 400 "the merge, job $merge" gone "$merge"
grep -q 'share 4 of 4 is missing' "farm/slurm-$merge.out" || fail "share 4 is not missed: $(cat "farm/slurm-$merge.out")"
[ ! -e farm/room.exr ] || fail "there is a picture without share 4"
grep -qF "went on from $kept in" "farm/slurm-${array}_3.out" ||
  fail "share 3 has not gone on from $kept: $(cat "farm/slurm-${array}_3.out")"
echo "  the merge names the share that is missing"

merge=$(submit 'array=17 shares.sbatch')
wait_for 300 "the merge, job $merge" gone "$merge"
sed 's/^/  /' "farm/slurm-$merge.out"
"$rtc" build "$scene" "${flags[@]}" -j 1 -o one.exr --quiet
cmp one.exr farm/room.exr
echo "  the same bytes as one process with one thread makes alone"

# By now its time is up; it was told so before.
wait_for 200 "the end of its time, job $timed" gone "$timed"
grep -q RUNNING timed.state && grep -q interrupted timed.log ||
  fail "a task whose time was up kept nothing: $(cat timed.state timed.log)"
echo "  a task whose time was up kept its samples"

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
  (cd pods && JOB_COMPLETION_INDEX=$index sh -c "$line" 2>"$desk/pod.log") || fail "pod $index: $(cat "$desk/pod.log")"
done
"$rtc" merge pods/parts/*.exr -o pods/all.exr --quiet
"$rtc" build pods/scene.rt --samples 16 --size 80x60 -o pods/one.exr -j 1 --quiet
cmp pods/one.exr pods/all.exr
echo "  eight pods, to the same bytes"

# A film by runs of its frames; whoever puts it together makes none of them again.
film=$(submit 'frames.sbatch film.rt 480')
wait_for 300 "the film, job $film" gone "$film"
[ "$(grep -c 'is done' "farm/slurm-$film.out")" = 7 ] || fail "not all frames were done: $(cat "farm/slurm-$film.out")"
"$rtc" build farm/film.rt --frames 7 --sweep "t = 0 to 1" --samples 8 --size 80x60 -o one.webp -j 1 --quiet
cmp one.webp farm/film.webp
echo "  a film of seven frames in three runs, to the same bytes"
