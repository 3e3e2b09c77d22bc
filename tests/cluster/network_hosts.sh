#!/usr/bin/env bash
# network_hosts.sh up N FOLDER | down N FOLDER: N 'hosts' for netns_test.py, the network namespaces nd1 to ndN on the
# bridge brmpi with the addresses 10.77.0.1 and on. Needs root and iproute2. Writes FOLDER/rsh, a remote shell to them.
set -euo pipefail
bridge=brmpi
folder=${3:?the folder of the remote shell}

add_host() {
  ip netns add "nd$1"
  ip link add "vh$1" type veth peer name eth0 netns "nd$1"
  ip link set "vh$1" master "$bridge" up
  ip -n "nd$1" addr add "10.77.0.$1/24" dev eth0
  ip -n "nd$1" link set eth0 up
  ip -n "nd$1" link set lo up
}

# Open MPI calls it as: rsh [ssh's options] HOST COMMAND…
write_remote_shell() {
  cat >"$folder/rsh" <<'EOF'
#!/bin/bash
while [[ $1 == -* ]]; do shift; done
host=$1
shift
namespace=nd${host##*.}
exec ip netns exec "$namespace" unshare --uts sh -c 'hostname "$0"; exec sh -c "$1"' "$namespace" "$*"
EOF
  chmod +x "$folder/rsh"
}

remove_host() {
  local process
  for process in $(ip netns pids "nd$1" 2>/dev/null || true); do kill -9 "$process" 2>/dev/null || true; done
  ip netns del "nd$1" 2>/dev/null || true
  ip link del "vh$1" 2>/dev/null || true
}

case ${1:-} in
  up)
    mkdir -p "$folder"
    ip link add "$bridge" type bridge
    ip link set "$bridge" up
    for i in $(seq "$2"); do add_host "$i"; done
    write_remote_shell
    ;;
  down)
    for i in $(seq "$2"); do remove_host "$i"; done
    ip link del "$bridge" 2>/dev/null || true
    rm -rf "$folder"
    ;;
  *) echo "network_hosts.sh: expected up N FOLDER or down N FOLDER" >&2; exit 2 ;;
esac
