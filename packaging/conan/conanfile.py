"""Conan 2 recipe of occlod, from the tree that it lies in: conan create packaging/conan"""
import os

from conan import ConanFile
from conan.tools.cmake import CMake, CMakeDeps, CMakeToolchain, cmake_layout
from conan.tools.files import copy, load, rmdir
from conan.tools.scm import Version
from conan.tools.system.package_manager import Apt

# Debian's packages for `system_packages`.
APT_PACKAGES = ["libfmt-dev", "libglm-dev", "libhwy-dev", "libstb-dev", "libtinygltf-dev", "libxxhash-dev", "libzstd-dev",
                "nlohmann-json3-dev"]
APT_PACKAGES_GL = ["libegl-dev", "libgl-dev"]


class OcclodConan(ConanFile):
    name = "occlod"
    description = "Continuous level of detail under a triangle budget, controlled by occlusion"
    license = "MIT"
    topics = ("graphics", "mesh", "level-of-detail", "occlusion-culling")
    package_type = "library"
    settings = "os", "arch", "compiler", "build_type"
    # system_packages: dependencies come from the distribution, not from Conan.
    options = {"shared": [True, False], "gl": [True, False], "system_packages": [True, False]}
    default_options = {"shared": False, "gl": True, "system_packages": False}

    def set_version(self):
        cmake = load(self, os.path.join(self.recipe_folder, "../../CMakeLists.txt"))
        self.version = cmake.split("project(occlod VERSION ")[1].split()[0]

    def export_sources(self):
        root = os.path.join(self.recipe_folder, "../..")
        for pattern in ("CMakeLists.txt", "LICENSE", "cmake/*", "lib/*", "packaging/pkgconfig/*"):
            copy(self, pattern, src=root, dst=self.export_sources_folder)

    def layout(self):
        cmake_layout(self)

    def validate(self):
        if Version(str(self.settings.get_safe("compiler.cppstd") or "20").replace("gnu", "")) < 20:
            from conan.errors import ConanInvalidConfiguration
            raise ConanInvalidConfiguration("occlod needs C++20: -s compiler.cppstd=20")

    def requirements(self):
        if self.options.system_packages:
            return
        self.requires("glm/1.0.1", transitive_headers=True)
        self.requires("fmt/11.0.2")
        self.requires("highway/1.2.0")
        self.requires("zstd/1.5.6")
        for headers in ("nlohmann_json/3.11.3", "stb/cci.20230920", "tinygltf/2.9.0", "xxhash/0.8.2"):
            self.requires(headers, visible=False)
        if self.options.gl:
            for headers in ("opengl-registry/20240721", "egl/system"):
                self.requires(headers, visible=False)

    def system_requirements(self):
        if self.options.system_packages:
            Apt(self).install(APT_PACKAGES + (APT_PACKAGES_GL if self.options.gl else []), check=True)

    def generate(self):
        toolchain = CMakeToolchain(self)
        for part in ("BENCH", "TESTS", "TOOLS", "VIEWER"):
            toolchain.cache_variables[f"OCCLOD_BUILD_{part}"] = False
        toolchain.cache_variables["OCCLOD_BUILD_GL"] = bool(self.options.gl)
        toolchain.cache_variables["OCCLOD_WITH_MESHOPTIMIZER"] = False
        toolchain.cache_variables["OCCLOD_WITH_ZLIB"] = False
        toolchain.cache_variables["OCCLOD_WARNINGS_AS_ERRORS"] = False
        toolchain.generate()
        dependencies = CMakeDeps(self)
        dependencies.set_property("highway", "cmake_file_name", "hwy")
        dependencies.set_property("highway::hwy", "cmake_target_name", "hwy::hwy")
        dependencies.generate()

    def build(self):
        cmake = CMake(self)
        cmake.configure()
        cmake.build()

    def package(self):
        CMake(self).install()
        copy(self, "LICENSE", src=self.source_folder, dst=os.path.join(self.package_folder, "licenses"))
        # Conan writes its own.
        rmdir(self, os.path.join(self.package_folder, "lib", "cmake"))
        rmdir(self, os.path.join(self.package_folder, "lib", "pkgconfig"))
        rmdir(self, os.path.join(self.package_folder, "share"))

    def package_info(self):
        library = self.cpp_info.components["occlod"]
        library.libs = ["occlod"]
        library.set_property("cmake_target_name", "occlod::occlod")
        library.set_property("pkg_config_name", "occlod")
        if self.options.system_packages:
            library.system_libs = [] if self.options.shared else ["fmt", "hwy", "zstd"]
        else:
            library.requires = ["glm::glm", "fmt::fmt", "highway::hwy", "zstd::zstdlib"]
        if self.settings.os in ("Linux", "FreeBSD"):
            library.system_libs.append("pthread")
        if self.options.gl:
            gl = self.cpp_info.components["gl"]
            gl.libs = ["occlod_gl"]
            gl.requires = ["occlod"]
            gl.set_property("cmake_target_name", "occlod::gl")
            gl.set_property("pkg_config_name", "occlod_gl")
            if self.settings.os in ("Linux", "FreeBSD"):
                gl.system_libs.append("dl")
