#!/usr/bin/env bash
# network_hosts.sh N FOLDER: makes N 'hosts' for netns_test.py, the network namespaces nd1 to ndN on the bridge brmpi
# with the addresses from 10.77.0.1 to 10.77.0.N. Needs root and iproute2. Writes FOLDER/rsh, a remote shell to them.
# The hosts end with the namespaces of the test (namespaces.py).
set -euo pipefail
bridge=brmpi
hosts=${1:?the number of hosts}
folder=${2:?the folder of the remote shell}

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

ip link add "$bridge" type bridge
ip link set "$bridge" up
for i in $(seq "$hosts"); do add_host "$i"; done
write_remote_shell
