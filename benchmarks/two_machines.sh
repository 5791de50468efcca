#!/bin/sh
# A campaign on two machines that are one: the second is a network namespace with a worker that does not see the tests,
# and both talk by TLS with certificates of a CA of their own. Root is needed, iproute2 and openssl.
#
#   sh benchmarks/two_machines.sh ROOT     ROOT: a folder with raw_tests/
set -eu
root=$(realpath "$1"); here=$(dirname "$(dirname "$(realpath "$0")")"); bin=$here/.venv/bin
scratch=$(mktemp -d); cd "$scratch"
end() { kill $(cat ./*.pid 2>/dev/null) 2>/dev/null || true; ip netns del hfa-two 2>/dev/null || true; rm -rf "$scratch"; }
trap end EXIT
openssl req -x509 -newkey rsa:2048 -nodes -keyout ca.key -out ca.pem -days 1 -subj /CN=ca 2>/dev/null
for who in scheduler worker client; do
  openssl req -newkey rsa:2048 -nodes -keyout $who.key -out $who.csr -subj /CN=$who 2>/dev/null
  openssl x509 -req -in $who.csr -CA ca.pem -CAkey ca.key -CAcreateserial -out $who.pem -days 1 2>/dev/null
done
ip netns add hfa-two
ip link add hfa-one type veth peer name hfa-two
ip link set hfa-two netns hfa-two
ip addr add 10.57.0.1/24 dev hfa-one; ip link set hfa-one up
ip netns exec hfa-two sh -c "ip addr add 10.57.0.2/24 dev hfa-two; ip link set hfa-two up; ip link set lo up"
tls() { echo "--tls-ca-file $scratch/ca.pem --tls-cert $scratch/$1.pem --tls-key $scratch/$1.key"; }
"$bin/dask" scheduler --host tls://10.57.0.1 --port 8786 --no-dashboard $(tls scheduler) > scheduler.log 2>&1 &
echo $! > scheduler.pid
ip netns exec hfa-two unshare -m sh -c "mount -t tmpfs none '$root' && OMP_NUM_THREADS=1 exec '$bin/dask' worker \
  tls://10.57.0.1:8786 --host 10.57.0.2 --nworkers 1 --nthreads 1 --no-dashboard $(tls worker)" > worker.log 2>&1 &
echo $! > worker.pid
sleep 8
cat > dask.yaml <<Y
distributed: {comm: {tls: {ca-file: $scratch/ca.pem, client: {cert: $scratch/client.pem, key: $scratch/client.key}}}}
Y
DASK_CONFIG=$scratch/dask.yaml "$bin/hfa" campaign --scheduler tls://10.57.0.1:8786 --root "$root" --force
