# A Slurm of one node of two processors, on this computer alone: loopback, ports that are free, everything in $slurm.
# To be sourced by bash as root: start_slurm FOLDER, end_slurm.

slurm_processes=()

free_port() {
  python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])'
}

# $1: what is waited for, $2: seconds, then a command that tells.
wait_for() {
  local what=$1 deadline=$((SECONDS + $2))
  shift 2
  until "$@" >/dev/null 2>&1; do
    [ "$SECONDS" -lt "$deadline" ] || { echo "cluster-test: waited in vain for $what" >&2; return 1; }
    sleep 0.2
  done
}

start_slurm() {
  slurm=$1
  local host ports memory_mb
  host=$(hostname -s)
  ports="$(free_port) $(free_port)"
  memory_mb=$(awk '/^MemTotal/ {print int($2 / 1024)}' /proc/meminfo)
  mkdir -p "$slurm"/{state,spool,munge}
  chmod 0755 "$slurm" "$slurm/munge"
  dd if=/dev/urandom bs=1024 count=1 of="$slurm/munge/key" status=none
  chmod 0400 "$slurm/munge/key"
  cat >"$slurm/slurm.conf" <<CONF
ClusterName=spinaltap
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=${ports% *}
SlurmdPort=${ports#* }
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$slurm/munge/socket
CredType=cred/munge
StateSaveLocation=$slurm/state
SlurmdSpoolDir=$slurm/spool
SlurmctldPidFile=$slurm/slurmctld.pid
SlurmdPidFile=$slurm/slurmd.pid
SlurmctldLogFile=$slurm/slurmctld.log
SlurmdLogFile=$slurm/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SwitchType=switch/none
MpiDefault=none
KillWait=10
ReturnToService=2
SchedulerParameters=sched_interval=2,batch_sched_delay=0
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 RealMemory=$memory_mb State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
  export SLURM_CONF=$slurm/slurm.conf
  # A later slurmd ends where it cannot have control groups of its own, as in a container; an earlier one (22.05) asks for
  # none with this configuration, and does not know the word.
  local version
  version=$(slurmd -V | grep -oE '[0-9]+\.[0-9]+' | head -n 1)
  if [ "$(printf '%s\n' 23.11 "$version" | sort -V | head -n 1)" = 23.11 ]; then
    echo "CgroupPlugin=disabled" >"$slurm/cgroup.conf"
  fi
  munged --foreground --force --key-file="$slurm/munge/key" --socket="$slurm/munge/socket" \
    --pid-file="$slurm/munge/pid" --log-file="$slurm/munge/log" --seed-file="$slurm/munge/seed" \
    >"$slurm/munged.out" 2>&1 &
  slurm_processes+=($!)
  wait_for "munged" 20 munge --no-input --socket="$slurm/munge/socket" || { cat "$slurm/munged.out" >&2; return 1; }
  slurmctld -D >"$slurm/slurmctld.out" 2>&1 &
  slurm_processes+=($!)
  wait_for "slurmctld" 30 sinfo || { tail -n 5 "$slurm/slurmctld.out" >&2; return 1; }
  slurmd -D -N "$host" >"$slurm/slurmd.out" 2>&1 &
  slurm_processes+=($!)
  wait_for "the node" 60 sh -c "sinfo --noheader --format=%t | grep -q idle" ||
    { tail -n 5 "$slurm/slurmd.out" "$slurm/slurmctld.out" >&2; return 1; }
}

# Ends what start_slurm started and what that started, by their numbers.
end_slurm() {
  [ ${#slurm_processes[@]} -gt 0 ] || return 0
  timeout 10 scancel --me >/dev/null 2>&1
  timeout 20 sh -c 'until [ -z "$(squeue --noheader 2>/dev/null)" ]; do sleep 0.5; done'
  local process n
  for ((n = ${#slurm_processes[@]} - 1; n >= 0; --n)); do
    process=${slurm_processes[$n]}
    kill "$process" 2>/dev/null
    for _ in $(seq 50); do kill -0 "$process" 2>/dev/null || break; sleep 0.1; done
    kill -KILL "$process" 2>/dev/null
    wait "$process" 2>/dev/null
  done
  slurm_processes=()
}
