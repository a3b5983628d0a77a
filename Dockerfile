# The course in a container: see environment.md.
FROM python:3.13-slim
RUN useradd --create-home --home-dir /srv/student student
WORKDIR /opt/arkaq
COPY requirements.lock ./
RUN pip install --no-cache-dir --require-hashes --requirement requirements.lock
COPY . .
RUN pip install --no-cache-dir --no-deps --no-build-isolation . \
    && echo '{"ServerApp": {"ip": "0.0.0.0"}}' > /usr/local/etc/jupyter/jupyter_server_config.json
USER student
WORKDIR /srv/student
RUN arkaq lab --copy-only
EXPOSE 8888
CMD ["arkaq", "lab", "--no-browser"]
