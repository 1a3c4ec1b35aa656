# Polyfly's tools, nodes, libraries and Python module, from the packages of `./run package`, made on this release:
#   docker build -t polyfly . && docker run -it polyfly offline_mpt --help
FROM debian:12
COPY build/packages/*.deb build/packages/Packages /srv/polyfly/
RUN echo "deb [trusted=yes] file:/srv/polyfly ./" > /etc/apt/sources.list.d/polyfly.list \
 && apt-get update \
 && apt-get install -y --no-install-recommends polyfly-tools polyfly-ros python3-polyfly libpolyfly-dev gnuplot-nox \
 && rm -rf /var/lib/apt/lists/*
WORKDIR /work
CMD ["bash"]
