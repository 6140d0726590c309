"""How colcon installs the package."""

from glob import glob

from setuptools import setup

NAME = "r1_monitor"

setup(
    name=NAME,
    version="0.1.0",
    packages=[NAME],
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml", "LICENSE", "README.md"]),
        (f"share/{NAME}/launch", glob("launch/*.launch.py")),
        (f"share/{NAME}/config", glob("config/*.yaml")),
    ],
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=True,
    maintainer="The authors of this example",
    maintainer_email="safety@example.org",
    description="Monitors a mobile robot among obstacles, and stops it",
    license="0BSD",
    entry_points={
        "console_scripts": [
            f"monitor = {NAME}.__main__:main",
            f"interceptor.py = {NAME}.interceptor:program",
        ]
    },
)
