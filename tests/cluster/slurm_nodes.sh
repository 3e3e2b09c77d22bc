#!/usr/bin/env bash
# slurm_nodes.sh N: starts a Slurm of N nodes on this host, for slurm_test.py. SLURM_CONF names the configuration to
# write; logs and state are in its folder. Without control groups and accounting; needs root, slurmctld, slurmd,
# slurm-client and munge. Daemons and /run end with the namespaces of the test (namespaces.py).
set -euo pipefail
nodes=${1:?the number of nodes}
folder=$(dirname "${SLURM_CONF:?the file to write}")
socket=/run/munge_gigabake  # munged refuses a socket below a folder that others may write

start_munge() {
  mkdir -p "$folder"/{state,spool,log,munge} "$socket"
  chmod 700 "$folder/munge"
  chmod 755 "$socket"
  (umask 077 && head -c 1024 /dev/urandom >"$folder/munge/key")
  munged --force --key-file="$folder/munge/key" --socket="$socket/s" --pid-file="$folder/munge/pid" \
    --log-file="$folder/munge/log" --seed-file="$folder/munge/seed"
}

# Short delays: a requeued job starts after 5 s (cred_expire), a killed one ends within 2 s (KillWait).
write_configuration() {
  local host=$1 i
  cat >"$SLURM_CONF" <<EOF
ClusterName=local
SlurmctldHost=$host(127.0.0.1)
AuthType=auth/munge
AuthInfo=socket=$socket/s,cred_expire=5
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
SlurmctldPort=16817
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool/%n
SlurmctldPidFile=$folder/ctld.pid
SlurmdPidFile=$folder/slurmd.%n.pid
SlurmctldLogFile=$folder/log/ctld.log
SlurmdLogFile=$folder/log/slurmd.%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=2,bf_interval=5,batch_sched_delay=0
MpiDefault=none
ReturnToService=2
SlurmdParameters=config_overrides
KillWait=2
JobRequeue=1
SlurmdTimeout=30
EOF
  for i in $(seq "$nodes"); do
    echo "NodeName=n$i NodeHostname=$host NodeAddr=127.0.0.1 Port=$((17000 + i)) CPUs=2 RealMemory=4000 State=UNKNOWN"
  done >>"$SLURM_CONF"
  echo "PartitionName=bake Nodes=n[1-$nodes] Default=YES MaxTime=INFINITE State=UP OverSubscribe=YES:4" >>"$SLURM_CONF"
}

idle_nodes() { sinfo -h -t idle -o %D 2>/dev/null | awk '{n += $1} END {print n + 0}'; }

start_munge
write_configuration "$(hostname -s)"
slurmctld -f "$SLURM_CONF"
for i in $(seq "$nodes"); do slurmd -f "$SLURM_CONF" -N "n$i"; done
for _ in $(seq 300); do
  if [ "$(idle_nodes)" = "$nodes" ]; then exit 0; fi
  sleep 0.1
done
echo "slurm_nodes.sh: the $nodes nodes are not idle after 30 s; $folder/log has the reason" >&2
exit 1
