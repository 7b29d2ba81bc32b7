# Hilt with the simulated robot. The file system may be read-only; the base lives in a volume:
#   docker build -t hilt .
#   docker run -it --rm --read-only --tmpfs /tmp -v hilt:/base hilt chat

FROM python:3.11-slim-bookworm AS build
WORKDIR /source
COPY pyproject.toml requirements.lock README.md LICENSE ./
COPY agent agent
COPY inference inference
COPY kb kb
COPY nlu nlu
COPY ontology ontology
COPY sim sim
RUN python -m venv /opt/hilt && \
    /opt/hilt/bin/pip install --no-cache-dir --constraint requirements.lock ".[sim]"

FROM python:3.11-slim-bookworm
COPY --from=build /opt/hilt /opt/hilt
RUN useradd --uid 10001 --no-create-home hilt && install -d -o hilt -g hilt /base
ENV PATH=/opt/hilt/bin:$PATH HOME=/tmp HILT_KB=/base
USER 10001
VOLUME /base
HEALTHCHECK --interval=1m --timeout=20s CMD ["hilt", "rules", "--json"]
ENTRYPOINT ["hilt"]
CMD ["--help"]
