# docker build -t fretc . && docker run --rm -v "$PWD:/project" --user "$(id -u)" fretc check
FROM python:3.12-slim AS build
WORKDIR /source
COPY . .
RUN pip wheel --no-cache-dir --wheel-dir /wheels .

FROM python:3.12-slim
RUN --mount=type=bind,from=build,source=/wheels,target=/wheels \
    pip install --no-cache-dir --no-index --no-compile /wheels/*.whl \
    && useradd --create-home --uid 1000 fretc
USER 1000
WORKDIR /project
ENTRYPOINT ["fretc"]
CMD ["--help"]
