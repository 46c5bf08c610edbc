# The command line as one static program, without CGAL and OpenGL; the files of the working folder are all that it sees:
#   docker build -t occlod .
#   docker run --rm -v "$PWD":/data -u "$(id -u)" occlod build statue.ply -o statue.olod
FROM debian:12-slim AS build
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates cmake g++ ninja-build python3
COPY . /source
WORKDIR /source
RUN cmake --preset static
RUN cmake --build build/static --target occlod_tool && strip build/static/tools/occlod
RUN mkdir -m 1777 /empty

FROM scratch
COPY --from=build /source/build/static/tools/occlod /usr/bin/occlod
COPY --from=build /source/LICENSE /licenses/occlod
COPY --from=build /empty /tmp
COPY --from=build /empty /data
WORKDIR /data
USER 65534:65534
ENTRYPOINT ["/usr/bin/occlod"]
