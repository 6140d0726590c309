# Called by catkin, which knows the rest from package.xml.
from setuptools import setup

from catkin_pkg.python_setup import generate_distutils_setup

setup(**generate_distutils_setup(packages=["r1_monitor"], package_dir={"": "src"}))
