# SPDX-License-Identifier: BSD-3-Clause
# The Python that ./run set up, and the tests that check the text of every Python file.

set(FIRN_PYTHON "" CACHE FILEPATH
  "Python with the packages of ./run; without them the reports, the lessons and the Python code are not tested")

# firn_python_has(RESULT MODULE…): ON if tests are built and FIRN_PYTHON imports the modules.
function(firn_python_has result)
  set(${result} OFF PARENT_SCOPE)
  if(FIRN_BUILD_TESTS AND FIRN_PYTHON)
    list(JOIN ARGN ", " modules)
    execute_process(COMMAND ${FIRN_PYTHON} -c "import ${modules}"
      RESULT_VARIABLE status OUTPUT_QUIET ERROR_QUIET)
    if(status EQUAL 0)
      set(${result} ON PARENT_SCOPE)
    endif()
  endif()
endfunction()

# Rules and their exceptions: pyproject.toml. Versions of the tools: requirements-dev.txt.
firn_python_has(has_tools ruff mypy)
if(has_tools)
  add_test(NAME python.ruff COMMAND ${FIRN_PYTHON} -m ruff check --no-cache)
  add_test(NAME python.format COMMAND ${FIRN_PYTHON} -m ruff format --check --diff --no-cache)
  # Types of what is imported count too: NumPy, Matplotlib, Jinja2, VTK.
  add_test(NAME python.types COMMAND ${FIRN_PYTHON} -m mypy --cache-dir ${PROJECT_BINARY_DIR}/mypy)
  set_tests_properties(python.ruff python.format python.types PROPERTIES
    TIMEOUT 600 WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
endif()
