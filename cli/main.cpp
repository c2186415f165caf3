#include "cli/commands.h"

int main(int argc, char** argv) {
  return sheaf::cli::runApplication(argc, argv);
}
