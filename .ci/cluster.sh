#!/usr/bin/env bash
# The scripts of assets/cluster on this machine: a picture in parts by GNU parallel, and by a Slurm of one node
# whose services listen on loopback alone. One task of each is killed by SIGKILL on the way. Both pictures must
# be the file that one process writes, byte by byte, and the killed task alone have run twice.
#
#   .ci/cluster.sh [BURNISH]
#
# What is not installed (Debian: parallel; slurmctld slurmd slurm-client munge) is skipped with a line that says so.
set -euo pipefail
cd "$(dirname "$0")/.."
real=$(realpath "${1:-target/release/burnish}")
made=$(mktemp -d)
services=()
stop() {
    for file in "${services[@]}"; do
        [ -e "$file" ] && kill "$(cat "$file")" 2>/dev/null || true
    done
    # Services that are ending may still write there.
    for _ in $(seq 50); do
        rm -rf "$made" 2>/dev/null && return
        sleep 0.1
    done
}
trap stop EXIT
scene=$made/ball.scn passes=960 parts=6
export EVERY=0 THREADS=1 TURNS BURNISH=$made/burnish

# Notes which part is run. The first run of part 3 is killed once it has a checkpoint.
cat >"$BURNISH" <<WRAPPER
#!/usr/bin/env bash
case "\$*" in
*"/part-3.exr"*"--every"*) part=3 ;;
*"--every"*) part=other ;;
*) exec "$real" "\$@" ;;
esac
echo "\$part \$1" >>"\$TURNS/runs"
if [ \$part = 3 ] && mkdir "\$TURNS/killed" 2>/dev/null; then
    "$real" "\$@" &
    until [ -e "\$TURNS/part-3.exr" ]; do kill -0 \$! || exit 1; done
    kill -KILL \$!
    wait \$!
else
    exec "$real" "\$@"
fi
WRAPPER
chmod +x "$BURNISH"

cat >"$scene" <<SCENE
screen 160 120
camera 0 -6 1  0.5  x 90
environment 0.2 0.3 0.4
brdf 0.6 0.5 0.4  0.2 0.2 0.2  20
sphere 0 0 1  1
sphere 0 0 -100  100
light 5 4 3
sphere 2 -1 3  0.5
SCENE
"$real" render -q "$scene" --passes $passes --uniform --checkpoint "$made/one.exr"

same() {
    cmp "$made/one.exr" "$TURNS/whole.exr"
    [ "$(grep -c '^other' "$TURNS/runs")" = $((parts - 1)) ]
    [ "$(grep -c '^3' "$TURNS/runs")" = 2 ]
    grep -q '^3 resume' "$TURNS/runs"
    echo "$1: $parts parts, one of them killed and run again, are the picture of one process."
}

if command -v parallel >/dev/null; then
    TURNS=$made/parallel
    assets/cluster/parallel.sh "$scene" $passes $parts "$TURNS" -j 2 --will-cite
    same "GNU parallel"
else
    echo "GNU parallel skipped: no parallel (Debian: parallel)"
fi

for program in slurmctld slurmd munged sbatch; do
    command -v $program >/dev/null || [ -x /usr/sbin/$program ] || {
        echo "Slurm skipped: no $program (Debian: slurmctld slurmd slurm-client munge)"
        exit 0
    }
done
[ "$(id -u)" = 0 ] || { echo "Slurm skipped: its node has to be started by root"; exit 0; }
PATH=$PATH:/usr/sbin
node=$(hostname -s) slurm=$made/slurm
mkdir -p "$slurm/state" "$slurm/spool"
chmod 755 "$made" "$slurm"
head -c 1024 /dev/urandom >"$slurm/munge.key"
chmod 600 "$slurm/munge.key"
cat >"$slurm/slurm.conf" <<CONF
ClusterName=burnish
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=17817
SlurmdPort=17818
AuthType=auth/munge
AuthInfo=socket=$slurm/munge.sock
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SchedulerType=sched/builtin
SchedulerParameters=batch_sched_delay=0,sched_min_interval=0
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
ReturnToService=2
SlurmdParameters=config_overrides
NodeName=$node NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES State=UP
CONF
export SLURM_CONF=$slurm/slurm.conf
services=("$slurm/slurmd.pid" "$slurm/slurmctld.pid" "$slurm/munge.pid")
started=yes
munged --force --key-file="$slurm/munge.key" --socket="$slurm/munge.sock" --pid-file="$slurm/munge.pid" \
    --log-file="$slurm/munge.log" --seed-file="$slurm/munge.seed" &&
    slurmctld -i && slurmd || started=no
for _ in $(seq 100); do
    [ "$started" = yes ] && sinfo --noheader --states=idle 2>/dev/null | grep -q "$node" && break
    sleep 0.1
done
sinfo --noheader --states=idle 2>/dev/null | grep -q "$node" || {
    echo "Slurm skipped: its services do not start here: $(tail -n 2 "$slurm"/*.log 2>/dev/null | tr '\n' ' ')"
    exit 0
}
TURNS=$made/slurm-parts
assets/cluster/slurm.sh "$scene" $passes $parts "$TURNS"
same "Slurm"
