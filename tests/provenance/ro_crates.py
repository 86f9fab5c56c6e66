"""Validate RO-Crates without a network, with the contexts of the package rocrate."""

import json
from importlib import resources

import requests
from rocrate_validator import services
from rocrate_validator.utils.http import HttpRequester

CONTEXT_URL = "https://w3id.org/ro/crate/1.1/context"


def local_context():
    """Return the RO-Crate context with the terms that version 1.1 spells in its own way."""
    text = resources.files("rocrate").joinpath("data/ro-crate.jsonld").read_text("utf-8")
    terms = json.loads(text)["@context"]
    terms = terms[-1] if isinstance(terms, list) else terms
    names = ("ComputationalWorkflow", "FormalParameter")
    return {"@context": terms | {name: f"https://bioschemas.org/{name}" for name in names}}


def find_issues(folder, profile, monkeypatch, cache):
    """Return the validator's complaints about the crate in a folder."""

    def get(requester, url, **options):
        assert url == CONTEXT_URL, f"the validator wants {url}"
        response = requests.Response()
        response.status_code = 200
        response.headers["Content-Type"] = "application/ld+json"
        response._content = json.dumps(local_context()).encode()
        return response

    monkeypatch.setattr(HttpRequester, "get", get, raising=False)
    settings = services.ValidationSettings(
        rocrate_uri=str(folder),
        profile_identifier=profile,
        requirement_severity="REQUIRED",
        offline=True,
        cache_path=cache / "http",
        skip_availability_check=True,
    )
    return [f"{i.check.identifier}: {i.message}" for i in services.validate(settings).get_issues()]
